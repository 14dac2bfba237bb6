#!/usr/bin/env python3
"""Vacuum robot: cleans a room in lanes, turns at walls and at stairs."""

import math

import rclpy
from geometry_msgs.msg import Pose2D, Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, UInt16

LANE, BACK, TURN_OUT, SHIFT, TURN_IN, DONE = range(6)


def wrap(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


class CarpetVacuum(Node):
    def __init__(self):
        super().__init__("carpet_vacuum")
        self.speed = self.declare_parameter("speed", 0.3).value
        self.turn_rate = self.declare_parameter("turn_rate", 1.2).value
        self.turn_gain = self.declare_parameter("turn_gain", 2.5).value
        self.lane_width = self.declare_parameter("lane_width", 0.28).value
        self.heading_gain = self.declare_parameter("heading_gain", 2.0).value
        self.cliff_raw = self.declare_parameter("cliff_raw", 230).value
        self.cliff_count = self.declare_parameter("cliff_count", 2).value
        self.back_off = self.declare_parameter("back_off", 0.12).value
        self.low_battery = self.declare_parameter("low_battery", 13.2).value
        self.dirt_boost = self.declare_parameter("dirt_boost", 40).value
        self.state = LANE
        self.pose = None
        self.bumped = False
        self.dark = 0
        self.mark = (0.0, 0.0)
        self.lane_heading = 0.0
        self.battery = 14.8
        self.boost = 0
        self.drive = self.create_publisher(Twist, "cmd_vel", 10)
        self.brush = self.create_publisher(Float32, "brush/duty", 10)
        self.finished = self.create_publisher(Bool, "vacuum/finished", 10)
        self.create_subscription(Pose2D, "odom/pose", self.on_pose, 10)
        self.create_subscription(Bool, "bumper", self.on_bumper, 10)
        self.create_subscription(UInt16, "cliff/front", self.on_cliff, 10)
        self.create_subscription(UInt16, "dirt/counts", self.on_dirt, 10)
        self.create_subscription(Float32, "battery/volts", self.on_battery, 10)
        self.create_timer(0.1, self.control)

    def on_pose(self, msg):
        self.pose = msg

    def on_bumper(self, msg):
        self.bumped = msg.data

    def on_cliff(self, msg):
        self.dark = self.dark + 1 if msg.data < self.cliff_raw else 0

    def on_dirt(self, msg):
        self.boost = 20 if msg.data > self.dirt_boost else max(0, self.boost - 1)

    def on_battery(self, msg):
        self.battery += 0.05 * (msg.data - self.battery)
        if self.battery < self.low_battery:
            self.get_logger().warn(f"battery at {self.battery:.1f} V, go home soon")

    def set_mark(self):
        self.mark = (self.pose.x, self.pose.y)

    def moved(self):
        return math.hypot(self.pose.x - self.mark[0], self.pose.y - self.mark[1])

    def turn_to(self, heading):
        """Return the turn rate, and whether the heading is reached."""
        error = wrap(heading - self.pose.theta)
        rate = max(-self.turn_rate, min(self.turn_rate, self.turn_gain * error))
        return rate, abs(error) < 0.04

    def control(self):
        if self.pose is None:
            return
        cmd = Twist()
        blocked = self.bumped or self.dark >= self.cliff_count
        if self.state == LANE:
            cmd.linear.x = self.speed
            cmd.angular.z = self.heading_gain * wrap(self.lane_heading - self.pose.theta)
            if blocked:
                cmd.linear.x = 0.0
                self.set_mark()
                self.state = BACK
        elif self.state == BACK:
            cmd.linear.x = -0.5 * self.speed
            if self.moved() > self.back_off:
                self.state = TURN_OUT
        elif self.state == TURN_OUT:
            cmd.angular.z, there = self.turn_to(math.pi / 2)
            if there:
                self.set_mark()
                self.state = SHIFT
        elif self.state == SHIFT:
            cmd.linear.x = 0.6 * self.speed
            if blocked:
                # the last lane is done
                self.get_logger().info("room finished")
                self.state = DONE
            elif self.moved() > self.lane_width:
                self.lane_heading = wrap(self.lane_heading + math.pi)
                self.state = TURN_IN
        elif self.state == TURN_IN:
            cmd.angular.z, there = self.turn_to(self.lane_heading)
            if there:
                self.state = LANE
        self.drive.publish(cmd)
        self.brush.publish(Float32(data=0.0 if self.state == DONE else 0.9 if self.boost else 0.6))
        self.finished.publish(Bool(data=self.state == DONE))


def main():
    rclpy.init()
    node = CarpetVacuum()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
