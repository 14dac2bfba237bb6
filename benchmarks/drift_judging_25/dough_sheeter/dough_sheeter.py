#!/usr/bin/env python3
"""Dough sheeter: rolls a block of dough to and fro between two rollers, with a smaller gap each time."""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32, String


class Step(Enum):
    EMPTY = 0
    SET_GAP = 1
    ROLL = 2
    FINISHED = 3
    ALARM = 4


class DoughSheeter(Node):
    """All thicknesses and gaps are in mm."""

    def __init__(self):
        super().__init__("dough_sheeter")
        self.declare_parameter("final_thickness", 4.0)
        self.declare_parameter("final_tolerance", 0.35)
        self.declare_parameter("max_reduction", 0.42)
        self.declare_parameter("belt_speed", 0.5)
        self.declare_parameter("gap_tolerance", 0.08)
        self.declare_parameter("max_passes", 24)
        self.declare_parameter("flour_every", 2)

        self.step = Step.EMPTY
        self.direction = 1
        self.passes = 0
        self.thickness = None
        self.wanted_gap = 40.0
        self.gap = 40.0
        self.spring_back = 1.08  # thickness after a pass, per gap; learned
        self.guard_open = False
        self.set_since = 0.0

        self.gap_pub = self.create_publisher(Float32, "rollers/gap_setpoint", 1)
        self.belt_pub = self.create_publisher(Float32, "belt/speed", 1)
        self.flour_pub = self.create_publisher(Bool, "flour/dust", 1)
        self.state_pub = self.create_publisher(String, "sheeter/state", 1)
        self.passes_pub = self.create_publisher(Int32, "sheeter/passes", 1)
        self.create_subscription(Float32, "rollers/gap", self.on_gap, 5)
        self.create_subscription(Float32, "dough/thickness", self.on_thickness, 5)
        self.create_subscription(Bool, "guard/open", self.on_guard, 1)
        self.create_timer(0.1, self.tick)

    def param(self, name):
        return self.get_parameter(name).value

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def on_guard(self, msg):
        if msg.data and not self.guard_open:
            self.get_logger().warning("guard is open")
        self.guard_open = msg.data

    def on_gap(self, msg):
        self.gap = msg.data

    def on_thickness(self, msg):
        """The camera measures the dough once on the table, and each time that it lies beside the rollers."""
        self.thickness = msg.data
        if self.step is Step.EMPTY:
            self.get_logger().info(f"block of {msg.data:.0f} mm")
            self.passes = 0
            self.plan()
        elif self.step is Step.ROLL:
            self.passes += 1
            self.passes_pub.publish(Int32(data=self.passes))
            ratio = msg.data / self.wanted_gap
            if 1.0 < ratio < 1.4:
                self.spring_back += 0.5 * (ratio - self.spring_back)
            self.direction = -self.direction
            self.plan()

    def plan(self):
        """Choose the gap of the next pass, or finish."""
        final = self.param("final_thickness")
        if self.thickness <= final + self.param("final_tolerance"):
            self.step = Step.FINISHED
            self.get_logger().info(f"{self.thickness:.1f} mm after {self.passes} passes")
            return
        if self.passes >= self.param("max_passes"):
            self.step = Step.ALARM
            self.get_logger().error(f"still {self.thickness:.1f} mm after {self.passes} passes")
            return
        smallest = final / self.spring_back
        gap = self.thickness * (1.0 - self.param("max_reduction"))
        self.wanted_gap = max(smallest, gap)
        self.set_since = self.now()
        self.step = Step.SET_GAP

    def tick(self):
        belt = 0.0
        dust = False
        if self.step is Step.SET_GAP:
            if abs(self.gap - self.wanted_gap) < self.param("gap_tolerance"):
                self.step = Step.ROLL
                dust = self.passes % self.param("flour_every") == 0
            elif self.now() - self.set_since > 8.0:
                self.get_logger().error("rollers do not reach their gap")
                self.step = Step.ALARM
        if self.step is Step.ROLL and not self.guard_open:
            belt = self.direction * self.param("belt_speed")
        self.gap_pub.publish(Float32(data=float(self.wanted_gap)))
        self.belt_pub.publish(Float32(data=float(belt)))
        if dust:
            self.flour_pub.publish(Bool(data=True))
        self.state_pub.publish(String(data=self.step.name.lower()))


def main():
    rclpy.init()
    node = DoughSheeter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
