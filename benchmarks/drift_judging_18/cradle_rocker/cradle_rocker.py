#!/usr/bin/env python3
"""Rocks a cradle: gives the frame a short push after each pass through the middle, until the swing is wide enough."""

import math

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, String

TARGET = 8.0  # degrees to each side
BASE_PUSH = 2.5  # N, holds the target with a newborn
TRIM = 0.8
TRIM_MIN = 0.3
TRIM_MAX = 1.2
EMPTY = 1.5  # kg
OVERLOAD = 15.0
TOO_WIDE = 14.0  # degrees, stop pushing


class CradleRocker(Node):
    def __init__(self):
        super().__init__("cradle_rocker")
        self.push_time = self.declare_parameter("push_time", 0.25).value
        self.kick_start = self.declare_parameter("kick_start", 3.0).value
        self.still = self.declare_parameter("still", 0.6).value
        self.smooth = self.declare_parameter("weight_filter", 0.1).value
        self.angle = None
        self.peak = 0.0
        self.highest = 0.0
        self.weight = None
        self.push_until = -1.0
        self.push = 0.0
        self.alarm = ""
        self.motor = self.create_publisher(Float32, "frame/push", 10)
        self.swing = self.create_publisher(Float32, "cradle/amplitude", 10)
        self.status = self.create_publisher(String, "cradle/status", 10)
        self.create_subscription(Float32, "cradle/angle", self.angle_cb, 10)
        self.create_subscription(Float32, "cradle/weight", self.weight_cb, 10)

    def seconds(self):
        return self.get_clock().now().nanoseconds / 1e9

    def weight_cb(self, msg):
        if self.weight is None:
            self.weight = msg.data
        self.weight += self.smooth * (msg.data - self.weight)
        if self.weight > OVERLOAD:
            self.alarm = "overload"
            self.get_logger().warn(f"{self.weight:.1f} kg in the cradle")

    def angle_cb(self, msg):
        before, self.angle = self.angle, msg.data
        now = self.seconds()
        if before is not None and self.ready():
            self.highest = max(self.highest, abs(msg.data))
            if before * msg.data < 0.0:
                self.passed_middle(now, 1.0 if msg.data > before else -1.0)
            elif self.highest < self.still and now > self.push_until + 2.0:
                # at rest: one push to get going
                self.push = self.kick_start
                self.push_until = now + self.push_time
        self.motor.publish(Float32(data=self.push if now < self.push_until else 0.0))
        self.swing.publish(Float32(data=self.peak))
        self.status.publish(String(data=self.alarm or ("rocking" if self.ready() else "empty")))

    def ready(self):
        return self.weight is not None and self.weight > EMPTY and not self.alarm

    def passed_middle(self, now, direction):
        self.peak, self.highest = self.highest, 0.0
        if self.peak > TOO_WIDE or math.isnan(self.peak):
            return
        trim = 1.0 + TRIM * (TARGET - self.peak) / TARGET
        trim = max(TRIM_MIN, min(TRIM_MAX, trim))
        self.push = direction * BASE_PUSH * trim
        self.push_until = now + self.push_time


def main():
    rclpy.init()
    node = CradleRocker()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
