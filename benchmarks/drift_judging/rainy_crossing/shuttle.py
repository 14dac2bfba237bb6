#!/usr/bin/env python3
"""Drive a campus shuttle along its road; stop for people on it."""

import rclpy
from braking import brake_distance, eased
from rclpy.node import Node
from std_msgs.msg import Float32

PACE = 3.0  # m/s


class Shuttle(Node):
    """Compute the throttle from the speed and the free distance ahead."""

    def __init__(self):
        super().__init__("shuttle")
        self.pace = self.declare_parameter("pace", PACE).value
        self.speed = 0.0
        self.ahead = None
        self.create_subscription(Float32, "/speed", self.on_speed, 10)
        self.create_subscription(Float32, "/ahead", self.on_ahead, 10)
        self.pedal = self.create_publisher(Float32, "/pedal", 10)
        self.create_timer(0.1, self.on_timer)

    def on_speed(self, msg):
        """Store the speed of the wheels, m/s."""
        self.speed += 0.7 * (msg.data - self.speed)

    def on_ahead(self, msg):
        """Store the free distance on the road, m."""
        self.ahead = msg.data

    def on_timer(self):
        """Send the pedal: 1 is full throttle, -1 full brake."""
        if self.ahead is None:
            return
        if self.ahead < brake_distance(self.speed):
            self.pedal.publish(Float32(data=-1.0))
            return
        self.pedal.publish(Float32(data=eased(self.pace - self.speed)))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Shuttle())


if __name__ == "__main__":
    main()
