#!/usr/bin/env python3
"""Drive a mower at the speed that its blade needs."""

import rclpy
from drive import bounded, throttle
from rclpy.node import Node
from std_msgs.msg import Float64


class Mower(Node):
    """Wanted speed to throttle."""

    def __init__(self):
        super().__init__("mower")
        self.pub = self.create_publisher(Float64, "throttle", 10)
        self.create_subscription(Float64, "wanted", self.on_wanted, 10)

    def on_wanted(self, msg):
        """Send the throttle."""
        command = throttle(msg.data)
        self.pub.publish(Float64(data=bounded(command)))


def main():
    """Run the node."""
    rclpy.init()
    rclpy.spin(Mower())


if __name__ == "__main__":
    main()
