#!/usr/bin/env python3
"""Patrol along a fence: visit and inspect the posts, and return to the dock before the battery is empty."""

import rclpy
from energy import EnergyModel, smoothed
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float64, Float64MultiArray

LOOK_SECONDS = 1.0
NEAR = 0.15


class Patrol(Node):
    """Drive outward, then home."""

    def __init__(self, model=None):
        super().__init__("patrol")
        self.model = model or EnergyModel()
        self.speed = self.declare_parameter("speed", 1.2).value
        self.crawl = self.declare_parameter("crawl_speed", 0.3).value
        self.posts = None
        self.next_post = 0
        self.place = None
        self.charge = None
        self.looking_until = None
        self.going_home = False
        self.create_subscription(Float64MultiArray, "posts", self.on_posts, 10)
        self.create_subscription(Float64, "odometer", self.on_odometer, 10)
        self.create_subscription(BatteryState, "battery", self.on_battery, 10)
        self.drive = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.25, self.on_timer)

    def on_posts(self, msg):
        """Store the posts, nearest first, in m from the dock."""
        self.posts = list(msg.data)

    def on_odometer(self, msg):
        """Store the distance from the dock."""
        self.place = msg.data

    def on_battery(self, msg):
        """Store the state of charge."""
        percent = 100.0 * msg.percentage
        self.charge = percent if self.charge is None else smoothed(self.charge, percent)

    def seconds(self):
        """Return the time."""
        return self.get_clock().now().nanoseconds / 1e9

    def on_timer(self):
        """Decide where to drive, and drive."""
        if self.posts is None or self.place is None or self.charge is None:
            return
        if self.next_post >= len(self.posts) or self.model.must_return(self.charge, self.place):
            self.going_home = True
        if self.going_home:
            self.go(-self.place)
            return
        if self.looking_until is not None:
            if self.seconds() < self.looking_until:
                return
            self.looking_until = None
            self.next_post += 1
            return
        away = self.posts[self.next_post] - self.place
        if abs(away) < NEAR:
            self.go(0.0)
            self.looking_until = self.seconds() + LOOK_SECONDS
        else:
            self.go(away)

    def go(self, away):
        """Publish the speed for the remaining distance."""
        cmd = Twist()
        if abs(away) > 1e-3:
            speed = self.speed if abs(away) > 0.6 else self.crawl
            cmd.linear.x = speed if away > 0.0 else -speed
        self.drive.publish(cmd)


def main():
    """Run until shutdown."""
    rclpy.init()
    rclpy.spin(Patrol())


if __name__ == "__main__":
    main()
