#!/usr/bin/env python3
"""Drive a cart to a mark on its rail."""

from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass(frozen=True)
class Settings:
    """The constants of the cart's controller."""

    gain: float = 2.0  # N/m
    most: float = 3.0  # N


class Cart(Node):
    """Position to force."""

    def __init__(self, settings):
        super().__init__("cart")
        self.settings = settings
        self.mark = 0.0
        self.force = self.create_publisher(Float64, "force", 10)
        self.create_subscription(Float64, "mark", self.on_mark, 10)
        self.create_subscription(Float64, "position", self.on_position, 10)

    def on_mark(self, msg):
        """Store the target position, m."""
        self.mark = msg.data

    def on_position(self, msg):
        """Push towards the mark."""
        error = self.mark - msg.data
        push = self.settings.gain * error
        most = self.settings.most
        self.force.publish(Float64(data=max(-most, min(most, push))))


def main():
    """Run the node."""
    rclpy.init()
    rclpy.spin(Cart(Settings()))


if __name__ == "__main__":
    main()
