#!/usr/bin/env python3
"""Turn the pages of a book under a scanner: suck a page, lift it, blow below it, sweep it over, take a picture."""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String


class State(Enum):
    DESCEND = 0
    SUCK = 1
    LIFT = 2
    BLOW = 3
    SWEEP = 4
    RELEASE = 5
    SCAN = 6
    FINISHED = 7


class PageTurner(Node):
    def __init__(self):
        super().__init__("page_turner")
        self.vacuum_level = self.declare_parameter("vacuum_level", -22.0).value  # kPa; holds a page
        self.lift_height = self.declare_parameter("lift_height", 0.030).value  # m
        self.lift_speed = self.declare_parameter("lift_speed", 0.10).value  # m/s
        self.blow_time = self.declare_parameter("blow_time", 0.5).value  # s
        self.sweep_speed = self.declare_parameter("sweep_speed", 120.0).value  # deg/s
        self.sweep_end = self.declare_parameter("sweep_end", 170.0).value  # deg

        self.state = State.DESCEND
        self.since = 0.0
        self.pressure = 0.0
        self.contact = False
        self.scanned = 0
        self.pages = None
        self.height = 0.05
        self.angle = 0.0
        self.dt = 0.05

        self.height_pub = self.create_publisher(Float32, "head/height", 10)
        self.arm_pub = self.create_publisher(Float32, "arm/angle", 10)
        self.vacuum_pub = self.create_publisher(Bool, "head/vacuum", 10)
        self.blower_pub = self.create_publisher(Bool, "blower", 10)
        self.trigger_pub = self.create_publisher(Bool, "scanner/trigger", 10)
        self.state_pub = self.create_publisher(String, "turner/state", 10)
        self.create_subscription(Float32, "head/pressure", self.on_pressure, 10)
        self.create_subscription(Bool, "head/contact", self.on_contact, 10)
        self.create_subscription(Int32, "scanner/scanned", self.on_scanned, 10)
        self.create_subscription(Int32, "book/pages", self.on_pages, 10)
        self.create_timer(self.dt, self.step)

    def on_pressure(self, msg):
        self.pressure = msg.data

    def on_contact(self, msg):
        self.contact = msg.data

    def on_scanned(self, msg):
        fresh = msg.data > self.scanned
        self.scanned = msg.data
        if fresh and self.state is State.SCAN:
            self.change(State.FINISHED if self.scanned == self.pages else State.DESCEND)

    def on_pages(self, msg):
        self.pages = msg.data

    def change(self, state):
        self.get_logger().debug(f"{self.state.name} -> {state.name}")
        self.state = state
        self.since = 0.0

    def step(self):
        if self.pages is None:
            return
        self.since += self.dt
        if self.state is State.DESCEND:
            self.angle = 0.0
            self.height = max(0.0, self.height - 2.0 * self.lift_speed * self.dt)
            if self.contact:
                self.change(State.SUCK)
        elif self.state is State.SUCK:
            if self.pressure < self.vacuum_level:
                self.height = 0.0
                self.change(State.LIFT)
        elif self.state is State.LIFT:
            self.height += self.lift_speed * self.dt
            if self.height >= self.lift_height:
                self.change(State.BLOW)
        elif self.state is State.BLOW:
            if self.since >= self.blow_time:
                self.change(State.SWEEP)
        elif self.state is State.SWEEP:
            self.angle = min(self.sweep_end, self.angle + self.sweep_speed * self.dt)
            if self.angle >= self.sweep_end:
                self.change(State.RELEASE)
        elif self.state is State.RELEASE:
            if self.pressure > 0.2 * self.vacuum_level:
                self.change(State.SCAN)
        self.publish()

    def publish(self):
        state = self.state
        self.height_pub.publish(Float32(data=self.height))
        self.arm_pub.publish(Float32(data=self.angle))
        self.vacuum_pub.publish(Bool(data=state in (State.SUCK, State.LIFT, State.BLOW, State.SWEEP)))
        self.blower_pub.publish(Bool(data=state in (State.LIFT, State.BLOW)))
        self.trigger_pub.publish(Bool(data=state is State.SCAN))
        self.state_pub.publish(String(data=state.name))


def main(args=None):
    rclpy.init(args=args)
    node = PageTurner()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
