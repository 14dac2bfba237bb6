#!/usr/bin/env python3
"""Shuttle of a brewery. Carries kegs from station to station and stops at the marks by a laser distance sensor."""

import math
import sys
from enum import IntEnum

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, UInt8


class State(IntEnum):
    IDLE = 0
    RUN = 1
    LOAD = 2
    BLOCKED = 3


class Shuttle(Node):
    RATE = 20.0
    V_MAX = 1.3  # m/s
    V_CREEP = 0.07
    ACCEL = 0.6  # m/s2
    DECEL = 1.15
    STOP_BEFORE = 0.02
    PERSON = 0.8  # wait if someone is closer than this (m)

    def __init__(self):
        super().__init__("shuttle")
        self.state = State.IDLE
        self.v = 0.0
        self.remaining = None
        self.free = 5.0
        self.ticks = 0
        self.load_ticks = int(1.5 * self.RATE)
        self.cmd_pub = self.create_publisher(Twist, "cmd_vel", 1)
        self.state_pub = self.create_publisher(UInt8, "shuttle/state", 1)
        self.horn_pub = self.create_publisher(Bool, "shuttle/horn", 1)
        self.create_subscription(Range, "laser/station", self.on_station, 10)
        self.create_subscription(Range, "sonar/front", self.on_sonar, 10)
        self.create_timer(1.0 / self.RATE, self.tick)

    def on_station(self, msg):
        self.remaining = min(msg.range, 25.0)

    def on_sonar(self, msg):
        self.free = 0.7 * msg.range + 0.3 * self.free

    def profile(self, d):
        """Speed that still allows a stop after d metres."""
        if d <= 0.0:
            return 0.0
        return max(self.V_CREEP, min(self.V_MAX, math.sqrt(2.0 * self.DECEL * d)))

    def tick(self):
        if self.remaining is None:
            return
        if self.state in (State.IDLE, State.BLOCKED):
            if self.free > self.PERSON + 0.1:
                self.state = State.RUN
        elif self.state == State.RUN:
            if self.free < self.PERSON:
                self.state = State.BLOCKED
            elif self.remaining < self.STOP_BEFORE:
                self.state = State.LOAD
                self.ticks = 0
        elif self.state == State.LOAD:
            self.ticks += 1
            if self.ticks >= self.load_ticks and self.remaining > 0.5:
                self.state = State.IDLE
        goal = self.profile(self.remaining - self.STOP_BEFORE) if self.state == State.RUN else 0.0
        self.v = min(goal, self.v + self.ACCEL / self.RATE)
        cmd = Twist()
        cmd.linear.x = self.v
        self.cmd_pub.publish(cmd)
        self.state_pub.publish(UInt8(data=int(self.state)))
        self.horn_pub.publish(Bool(data=bool(self.state == State.BLOCKED or 0.0 < self.v < 0.15)))


if __name__ == "__main__":
    rclpy.init(args=sys.argv)
    rclpy.spin(Shuttle())
    rclpy.shutdown()
