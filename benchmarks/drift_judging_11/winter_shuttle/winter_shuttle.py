#!/usr/bin/env python3
"""Shuttle bus on a fixed route of a campus: slow down for bends, stop at stops."""

import math

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float32

CRUISE = 7.0  # m/s
BRAKING = 1.6  # m/s2
CORNERING = 2.2  # m/s2
STOPS = [50.0, 105.0]  # places along the route (m)
BENDS = [(8.0, 20.0, 12.0), (70.0, 82.0, 15.0)]  # from, to, radius
WAIT = 2.0  # s


class WinterShuttle(Node):
    def __init__(self):
        super().__init__("winter_shuttle")
        self.s, self.v = 0.0, 0.0
        self.stop = 0
        self.arrived = None
        self.pub = self.create_publisher(Float32, "accelerator", 1)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_timer(0.25, self.on_timer)

    def on_odom(self, msg):
        self.s = msg.pose.pose.position.x
        self.v = msg.twist.twist.linear.x

    def braking_speed(self, distance, end=0.0):
        return math.sqrt(max(0.0, end**2 + 2 * BRAKING * distance))

    def wanted(self):
        v = CRUISE
        if self.stop < len(STOPS):
            v = min(v, self.braking_speed(STOPS[self.stop] - 1.0 - self.s))
        for start, end, radius in BENDS:
            bend = math.sqrt(CORNERING * radius)
            if self.s < start:
                v = min(v, self.braking_speed(start - 1.5 - self.s, bend))
            elif self.s < end:
                v = min(v, bend)
        return v

    def on_timer(self):
        now = self.get_clock().now().nanoseconds / 1e9
        if self.arrived is not None:
            if now - self.arrived > WAIT:
                self.arrived = None
                self.stop += 1
        elif self.stop < len(STOPS) and self.v < 0.3 and abs(STOPS[self.stop] - self.s) < 3.0:
            self.arrived = now
        elif self.stop < len(STOPS) and self.s > STOPS[self.stop] + 3.0:
            self.get_logger().error("missed a stop")
            self.stop += 1
        a = -1.0 if self.arrived is not None else 1.5 * (self.wanted() - self.v)
        self.pub.publish(Float32(data=max(-4.0, min(1.5, a))))


def main():
    rclpy.init()
    rclpy.spin(WinterShuttle())


if __name__ == "__main__":
    main()
