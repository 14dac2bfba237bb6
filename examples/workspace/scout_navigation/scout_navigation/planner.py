"""Drive ahead, and turn away from the nearest obstacle."""

import math

import rclpy
from geometry_msgs.msg import PointStamped, Twist
from rclpy.node import Node


class Planner(Node):
    """Publishes a command ten times a second, and stops if no obstacle was reported for half a second."""

    def __init__(self):
        super().__init__("planner")
        self.obstacle = None
        self.heard = self.get_clock().now()
        self.command = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(PointStamped, "obstacles", self.on_obstacle, 10)
        self.create_timer(0.1, self.steer)

    def on_obstacle(self, obstacle):
        """Remember the nearest obstacle, and when it was reported."""
        self.obstacle = obstacle.point
        self.heard = self.get_clock().now()

    def steer(self):
        """Publish the next command."""
        command = Twist()
        age = (self.get_clock().now() - self.heard).nanoseconds / 1e9
        if self.obstacle is not None and age < 0.5:
            command.linear.x = 0.2 * math.hypot(self.obstacle.x, self.obstacle.y)
            command.angular.z = -1.0 if self.obstacle.y > 0.0 else 1.0
        self.command.publish(command)


def main():
    """Start the node."""
    rclpy.init()
    rclpy.spin(Planner())
