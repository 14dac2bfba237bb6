#!/usr/bin/env python3
"""Drive a cart up to its dock: slower the nearer it comes, on a course towards the middle of the dock."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

PERIOD = 0.05  # of the control loop: s
APPROACH = 2.5  # speed per distance to the dock: 1/s
MAX_SPEED = 0.8  # m/s
STEER = 2.0  # turn rate per error of the course: 1/s


class Docking(Node):
    """Publish a command in each period, from the last odometry."""

    def __init__(self):
        super().__init__("docking")
        self.declare_parameter("dock", 2.0)
        self.dock = self.get_parameter("dock").value
        self.pose = None
        self.create_subscription(Odometry, "/odom", self.on_odometry, 10)
        self.command = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(PERIOD, self.on_timer)

    def on_odometry(self, msg):
        """Store the pose."""
        self.pose = msg.pose.pose

    def on_timer(self):
        """Send one command."""
        if self.pose is None:
            return
        heading = 2.0 * math.atan2(self.pose.orientation.z, self.pose.orientation.w)
        ahead = self.dock - self.pose.position.x
        course = math.atan2(-self.pose.position.y, max(ahead, 0.3))
        cmd = Twist()
        cmd.linear.x = max(-MAX_SPEED, min(MAX_SPEED, APPROACH * ahead))
        cmd.angular.z = STEER * (course - heading)
        self.command.publish(cmd)


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Docking()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
