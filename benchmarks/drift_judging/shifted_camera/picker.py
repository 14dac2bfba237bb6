#!/usr/bin/env python3
"""Pick parts from a tray: convert pixels of the camera to a gripper position, move there, and close the gripper."""

import math

import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import Bool


class Picker(Node):
    """Look at the part, go there, and close the gripper."""

    def __init__(self):
        super().__init__("picker")
        self.declare_parameter("camera_x", 0.12)  # position of the picture's middle (m)
        self.declare_parameter("camera_y", 0.05)
        self.declare_parameter("metres_per_pixel", 0.0005)
        self.declare_parameter("close_within", 0.003)
        self.camera_x = self.get_parameter("camera_x").value
        self.camera_y = self.get_parameter("camera_y").value
        self.scale = self.get_parameter("metres_per_pixel").value
        self.close_within = self.get_parameter("close_within").value
        self.part = None
        self.gripper = None
        self.steady = 0
        self.create_subscription(Point, "/part", self.on_part, 10)
        self.create_subscription(Point, "/gripper", self.on_gripper, 10)
        self.velocity = self.create_publisher(Point, "/velocity", 10)
        self.fingers = self.create_publisher(Bool, "/close", 10)
        self.create_timer(0.05, self.on_timer)

    def on_part(self, msg):
        """Store the smoothed position of the part in the image, px."""
        seen = (self.camera_x + self.scale * (msg.x - 320.0), self.camera_y + self.scale * (msg.y - 240.0))
        if self.part is None:
            self.part = seen
        self.part = tuple(0.8 * old + 0.2 * new for old, new in zip(self.part, seen, strict=True))

    def on_gripper(self, msg):
        """Store the position of the gripper, m."""
        self.gripper = (msg.x, msg.y)

    def on_timer(self):
        """Move the gripper; close it after three periods at the goal."""
        if self.part is None or self.gripper is None:
            return
        dx = self.part[0] - self.gripper[0]
        dy = self.part[1] - self.gripper[1]
        away = math.hypot(dx, dy)
        if away < self.close_within:
            self.steady += 1
        else:
            self.steady = 0
        speed = min(0.25, 4.0 * away)
        cmd = Point()
        if away > 0.0005:
            cmd.x = speed * dx / away
            cmd.y = speed * dy / away
        self.velocity.publish(cmd)
        self.fingers.publish(Bool(data=self.steady >= 3))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Picker())


if __name__ == "__main__":
    main()
