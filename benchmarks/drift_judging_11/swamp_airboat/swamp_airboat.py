#!/usr/bin/env python3
"""Keep an airboat on a line of GPS points through a swamp."""

import math

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node

LOOK_AHEAD = 6.0  # m
K_HEADING = 1.1
K_RATE = 0.2
RUDDER = 0.7  # rad
POINTS = [(0.0, 0.0), (25.0, 4.0), (50.0, 0.0), (80.0, 6.0), (140.0, 6.0)]


class SwampAirboat(Node):
    def __init__(self):
        super().__init__("swamp_airboat")
        self.pose = None
        self.last = None
        self.thrust = self.declare_parameter("thrust", 0.6).value
        self.create_subscription(PoseStamped, "fix", self.on_fix, 10)
        self.pub = self.create_publisher(Twist, "cmd", 10)
        self.create_timer(0.2, self.tick)

    def on_fix(self, msg):
        q = msg.pose.orientation
        self.pose = (msg.pose.position.x, msg.pose.position.y, 2.0 * math.atan2(q.z, q.w))

    def line(self, x):
        """Return the y of the line at x."""
        for (x0, y0), (x1, y1) in zip(POINTS, POINTS[1:]):
            if x <= x1:
                return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
        return POINTS[-1][1]

    def tick(self):
        if self.pose is None:
            return
        x, y, heading = self.pose
        rate = 0.0 if self.last is None else (heading - self.last) / 0.2
        self.last = heading
        bearing = math.atan2(self.line(x + LOOK_AHEAD) - y, LOOK_AHEAD)
        error = math.atan2(math.sin(bearing - heading), math.cos(bearing - heading))
        cmd = Twist()
        cmd.linear.x = self.thrust if abs(error) < 0.5 else 0.8 * self.thrust
        cmd.angular.z = max(-RUDDER, min(RUDDER, K_HEADING * error - K_RATE * rate))
        self.pub.publish(cmd)


def main():
    rclpy.init()
    rclpy.spin(SwampAirboat())


if __name__ == "__main__":
    main()
