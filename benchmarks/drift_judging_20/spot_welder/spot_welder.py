#!/usr/bin/env python3
"""Spot welder: closes the gun on a flange, welds, holds, opens, and reports each spot to the robot that carries it."""

import rclpy
from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String
from weld_schedule import Schedule

OPEN, SQUEEZE, WELD, HOLD, RELEASE = range(5)
NAMES = ("open", "squeeze", "weld", "hold", "release")


class SpotWelder(Node):
    def __init__(self, schedule):
        super().__init__("spot_welder")
        self.declare_parameters(
            "",
            [
                ("period", 0.01),
                ("force_ok", 0.9),  # share of the force before current flows
                ("squeeze_limit", 1.0),
                ("coating_warn", 40.0),  # um, hot dip that was not ordered
            ],
        )
        self.s = schedule
        self.period = self.get_parameter("period").value
        self.force_ok = self.get_parameter("force_ok").value
        self.squeeze_limit = self.get_parameter("squeeze_limit").value
        self.coating_warn = self.get_parameter("coating_warn").value
        self.state = OPEN
        self.elapsed = 0.0
        self.force = 0.0
        self.welds = 0
        self.in_place = False
        self.amps_pub = self.create_publisher(Float32, "gun/kiloamps", 10)
        self.force_pub = self.create_publisher(Float32, "gun/force", 10)
        self.count_pub = self.create_publisher(Int32, "gun/welds", 10)
        self.state_pub = self.create_publisher(String, "gun/state", 10)
        self.create_subscription(Bool, "robot/in_place", self.on_place, 10)
        self.create_subscription(WrenchStamped, "gun/load", self.on_load, 10)
        self.create_subscription(Int32, "caps/welds", self.on_caps, 10)
        self.create_subscription(Float32, "sheet/coating", self.on_coating, 10)
        self.create_timer(self.period, self.tick)

    def on_place(self, msg):
        self.in_place = msg.data

    def on_load(self, msg):
        self.force = msg.wrench.force.z / 1000.0

    def on_caps(self, msg):
        self.welds = msg.data

    def on_coating(self, msg):
        if msg.data > self.coating_warn:
            self.get_logger().warn(f"coating of {msg.data:.0f} um")

    def to(self, state):
        self.state = state
        self.elapsed = 0.0

    def current(self):
        """Current in kA at this moment of the weld."""
        rise = min(1.0, self.elapsed / self.s.upslope)
        return rise * self.s.kiloamps(self.welds)

    def tick(self):
        s = self.s
        self.elapsed += self.period
        kiloamps, force = 0.0, s.force
        if self.state == OPEN:
            force = 0.0
            if self.in_place:
                self.to(SQUEEZE)
        elif self.state == SQUEEZE:
            if self.elapsed > s.squeeze and self.force > self.force_ok * s.force:
                self.to(WELD)
            elif self.elapsed > self.squeeze_limit:
                self.get_logger().error("gun does not reach its force")
                self.to(RELEASE)
        elif self.state == WELD:
            kiloamps = self.current()
            if self.elapsed > s.upslope + s.weld:
                kiloamps = 0.0
                self.to(HOLD)
        elif self.state == HOLD:
            if self.elapsed > s.hold:
                self.to(RELEASE)
        elif self.state == RELEASE:
            force = 0.0
            if not self.in_place:
                self.to(OPEN)
        self.amps_pub.publish(Float32(data=kiloamps))
        self.force_pub.publish(Float32(data=force))
        self.count_pub.publish(Int32(data=self.welds))
        self.state_pub.publish(String(data=NAMES[self.state]))


def main():
    rclpy.init()
    node = SpotWelder(Schedule())
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
