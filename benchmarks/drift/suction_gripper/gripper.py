#!/usr/bin/env python3
"""Pick a carton with a suction cup: build up vacuum, lift gently, put down."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, UInt8

VACUUM = [22.0, 30.0, 40.0]  # vacuum for each size of carton (kPa)
LIFT_SPEED = [0.5, 0.4, 0.3]  # speed for each size of carton (m/s)
HEIGHT = 0.6  # height to which the carton is lifted, m
RAMP = 0.05  # change of speed per period (m/s)


class Gripper(Node):
    """Reach down, suck, lift."""

    def __init__(self):
        super().__init__("gripper")
        self.size = 0
        self.vacuum = 0.0
        self.height = 0.0
        self.sealed = False
        self.speed = 0.0
        self.create_subscription(UInt8, "/size", self.on_size, 10)
        self.create_subscription(Float32, "/vacuum", self.on_vacuum, 10)
        self.create_subscription(Float32, "/height", self.on_height, 10)
        self.pump = self.create_publisher(Float32, "/pump", 10)
        self.lift = self.create_publisher(Float32, "/lift", 10)
        self.create_timer(0.05, self.on_timer)

    def on_size(self, msg):
        """Store the size of the carton: 0, 1 or 2."""
        self.size = msg.data

    def on_vacuum(self, msg):
        """Store the smoothed vacuum under the cup, kPa."""
        self.vacuum += 0.5 * (msg.data - self.vacuum)

    def on_height(self, msg):
        """Store the height of the cup, m."""
        self.height = msg.data

    def on_timer(self):
        """Send the commands of this period."""
        wanted = VACUUM[self.size]
        missing = wanted - self.vacuum
        power = 0.3 + 0.08 * missing
        self.pump.publish(Float32(data=max(0.0, min(1.0, power))))
        if missing < 3.0:
            self.sealed = True
        goal = 0.0
        if self.sealed:
            left = HEIGHT - self.height
            goal = min(LIFT_SPEED[self.size], 2.5 * left)
        change = max(-RAMP, min(RAMP, goal - self.speed))
        self.speed += change
        self.lift.publish(Float32(data=self.speed))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Gripper())


if __name__ == "__main__":
    main()
