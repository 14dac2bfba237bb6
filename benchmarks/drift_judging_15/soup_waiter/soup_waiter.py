#!/usr/bin/env python3
"""Drives a serving robot along an aisle to a table and stops for guests."""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

TABLE_X = 9.0  # m
STOP_DISTANCE = 1.1  # distance to a guest (m)
SLOW_DISTANCE = 2.0
FRONT = math.radians(20.0)


class SoupWaiter(Node):
    def __init__(self):
        super().__init__("soup_waiter")
        self.declare_parameter("max_speed", 0.9)
        self.declare_parameter("slow_speed", 0.45)
        self.declare_parameter("k_goal", 0.7)
        self.declare_parameter("k_heading", 1.5)
        self.declare_parameter("k_lateral", 0.8)
        self.declare_parameter("max_turn", 0.6)
        self.declare_parameter("goal_tolerance", 0.05)
        self.declare_parameter("scan_timeout", 0.5)
        self.pose = None
        self.front = float("inf")
        self.scan_time = None
        self.cmd_pub = self.create_publisher(Twist, "cmd_vel", 1)
        self.status_pub = self.create_publisher(String, "waiter/status", 1)
        self.create_subscription(Odometry, "odom", self.odom_cb, 10)
        self.create_subscription(LaserScan, "scan", self.scan_cb, 10)
        self.create_timer(0.1, self.control)

    def p(self, name):
        return self.get_parameter(name).get_parameter_value().double_value

    def odom_cb(self, msg):
        q = msg.pose.pose.orientation
        yaw = math.atan2(2.0 * (q.w * q.z), 1.0 - 2.0 * q.z * q.z)
        self.pose = (msg.pose.pose.position.x, msg.pose.pose.position.y, yaw)

    def scan_cb(self, msg):
        nearest = float("inf")
        for i, distance in enumerate(msg.ranges):
            angle = msg.angle_min + i * msg.angle_increment
            if abs(angle) < FRONT and msg.range_min < distance < msg.range_max:
                nearest = min(nearest, distance)
        self.front = nearest
        self.scan_time = self.get_clock().now()

    def forward_speed(self, left):
        speed = min(self.p("max_speed"), self.p("k_goal") * left)
        if self.front < STOP_DISTANCE:
            return 0.0
        if self.front < SLOW_DISTANCE:
            speed = min(speed, self.p("slow_speed"))
        return speed

    def control(self):
        cmd = Twist()
        if self.pose is None or self.scan_time is None:
            return
        age = (self.get_clock().now() - self.scan_time).nanoseconds * 1e-9
        left = TABLE_X - self.pose[0]
        if left < self.p("goal_tolerance"):
            self.status_pub.publish(String(data="SERVED"))
        elif age < self.p("scan_timeout"):
            cmd.linear.x = self.forward_speed(left)
            turn = -self.p("k_lateral") * self.pose[1] - self.p("k_heading") * self.pose[2]
            cmd.angular.z = max(-self.p("max_turn"), min(self.p("max_turn"), turn))
        self.cmd_pub.publish(cmd)


def main():
    rclpy.init()
    node = SoupWaiter()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
