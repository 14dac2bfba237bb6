#!/usr/bin/env python3
"""Keep the level of a tank."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32

LEVEL = 1.5  # m
GAIN = 0.9
TRIM = 0.15  # gain of the integral part (1/s)
DEAD = 0.01  # m


class Filler(Node):
    """Control the pump by the level."""

    def __init__(self, smoothing=0.4):
        super().__init__("filler")
        self.smoothing = smoothing
        self.level = None
        self.sum = 0.0
        self.create_subscription(Float32, "/level", self.on_level, 10)
        self.pump = self.create_publisher(Float32, "/pump", 10)
        self.alarm = self.create_publisher(Float32, "/alarm", 10)
        self.create_timer(0.5, self.on_timer)

    def on_level(self, msg):
        """Store the smoothed level."""
        if self.level is None:
            self.level = msg.data
        self.level += self.smoothing * (msg.data - self.level)

    def on_timer(self):
        """Send one command."""
        if self.level is None:
            return
        missing = LEVEL - self.level
        if abs(missing) < DEAD:
            missing = 0.0
        self.sum = max(0.0, min(1.0, self.sum + TRIM * missing))
        power = GAIN * missing + self.sum
        self.pump.publish(Float32(data=max(0.0, min(1.0, power))))
        self.alarm.publish(Float32(data=1.0 if missing > 0.4 else 0.0))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Filler())


if __name__ == "__main__":
    main()
