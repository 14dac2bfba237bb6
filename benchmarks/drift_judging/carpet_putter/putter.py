#!/usr/bin/env python3
"""Push a puck once, at the speed with which it slides to a mark."""

import math

import rclpy
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import Float64

FLOOR = {"friction": 0.09, "gravity": 9.81}
PUSH = {"ramp": 12.0, "follow": 0.15, "least": 0.2}  # m/s², m, m/s


class Putter(Node):
    """Wait for mark and puck, accelerate, push, and stop."""

    def __init__(self):
        super().__init__("putter")
        self.away = None
        self.speed = 0.0
        self.done = False
        self.create_subscription(Point, "/mark", self.on_mark, 10)
        self.arm = self.create_publisher(Float64, "/arm", 10)
        self.create_timer(0.02, self.on_timer)

    def on_mark(self, msg):
        """Store the distance from puck to mark, m."""
        self.away = math.hypot(msg.x, msg.y)

    def wanted(self):
        """Return the speed at which the puck has to leave."""
        slide = self.away - PUSH["follow"]
        return math.sqrt(max(0.0, 2.0 * FLOOR["friction"] * FLOOR["gravity"] * slide))

    def on_timer(self):
        """Run up until the arm is fast enough, then stop it."""
        if self.away is None:
            return
        goal = max(PUSH["least"], self.wanted())
        if self.speed >= goal:
            self.done = True
        if self.done:
            self.arm.publish(Float64(data=0.0))
            return
        self.speed = min(goal, self.speed + 0.02 * PUSH["ramp"])
        self.arm.publish(Float64(data=self.speed))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Putter())


if __name__ == "__main__":
    main()
