#!/usr/bin/env python3
"""Pull a hospital bed to the next bay of its ward."""

from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass
class Gains:
    approach: float = 0.55  # 1/s
    keep: float = 0.9  # 1/s
    swing: float = 0.6


class BedMover(Node):
    def __init__(self, gains=None):
        super().__init__("bed_mover")
        self.gains = gains or Gains()
        self.bay = None
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Float64, "bay", self.set_bay, 10)
        self.create_subscription(Odometry, "odom", self.odometry, 10)

    def set_bay(self, msg):
        self.bay = msg.data

    def odometry(self, msg):
        if self.bay is None:
            return
        left = self.bay - msg.pose.pose.position.x
        across = msg.pose.pose.position.y
        cmd = Twist()
        cmd.linear.x = self.gains.approach * left
        cmd.linear.y = -self.gains.keep * across - self.gains.swing * msg.twist.twist.linear.y
        self.pub.publish(cmd)


def main():
    rclpy.init()
    rclpy.spin(BedMover())


if __name__ == "__main__":
    main()
