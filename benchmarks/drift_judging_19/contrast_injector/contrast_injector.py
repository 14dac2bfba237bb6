#!/usr/bin/env python3
"""Injector for contrast agent: pushes a bolus at a flow, then saline, and stops when the line is blocked."""

from dataclasses import dataclass
from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, String


@dataclass(frozen=True)
class Settings:
    period: float = 0.02  # s
    flow: float = 2.0  # ml/s
    bolus: float = 8.0  # ml of contrast agent
    flush: float = 4.0  # ml of saline
    flush_flow: float = 2.0  # ml/s
    ramp: float = 4.0  # ml/s in a second
    ml_per_mm: float = 0.55
    blocked_kpa: float = 850.0
    blocked_count: int = 3
    filter_share: float = 0.5
    air_kpa: float = 20.0  # less: the line is not connected
    air_after: float = 1.0  # s
    pull_back: float = 0.15  # ml, takes the pressure off a blocked line


class Step(Enum):
    READY = "ready"
    BOLUS = "bolus"
    FLUSH = "flush"
    DONE = "done"
    BLOCKED = "blocked"
    OPEN = "open"


class ContrastInjector(Node):
    def __init__(self):
        super().__init__("contrast_injector")
        self.settings = Settings()
        self.step = Step.READY
        self.flow = 0.0
        self.given = 0.0
        self.kpa = 0.0
        self.high = 0
        self.armed = False
        self.began = 0.0
        self.back = 0.0
        self.piston = self.create_publisher(Float32, "piston/speed", 10)
        self.valve = self.create_publisher(Bool, "valve/saline", 10)
        self.state = self.create_publisher(String, "injector/state", 10)
        self.create_subscription(Float32, "line/kpa", self.on_pressure, 10)
        self.create_subscription(Float32, "piston/position", self.on_piston, 10)
        self.create_subscription(Bool, "injector/start", self.on_start, 10)
        self.create_timer(self.settings.period, self.tick)

    def now(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_start(self, msg):
        if msg.data and not self.armed:
            self.armed = True
            self.began = self.now()

    def on_piston(self, msg):
        self.given = msg.data * self.settings.ml_per_mm

    def on_pressure(self, msg):
        s = self.settings
        self.kpa += s.filter_share * (msg.data - self.kpa)
        self.high = self.high + 1 if self.kpa > s.blocked_kpa else 0
        if self.step not in (Step.BOLUS, Step.FLUSH):
            return
        if self.high >= s.blocked_count:
            self.get_logger().error(f"line is blocked, {self.kpa:.0f} kPa at {self.given:.1f} ml")
            self.back = s.pull_back
            self.step = Step.BLOCKED
        elif self.kpa < s.air_kpa and self.now() - self.began > s.air_after:
            self.get_logger().error("no pressure, is the line connected?")
            self.step = Step.OPEN

    def wanted(self):
        """Return the flow of the current step, in ml/s."""
        s = self.settings
        if self.step == Step.BOLUS:
            return s.flow
        if self.step == Step.FLUSH:
            return s.flush_flow
        return 0.0

    def tick(self):
        s = self.settings
        if self.step == Step.READY and self.armed:
            self.step = Step.BOLUS
        elif self.step == Step.BOLUS and self.given >= s.bolus:
            self.step = Step.FLUSH
        elif self.step == Step.FLUSH and self.given >= s.bolus + s.flush:
            self.step = Step.DONE
        change = s.ramp * s.period
        if self.step == Step.BLOCKED:
            self.flow = -2.0 if self.back > 0.0 else 0.0
            self.back -= 2.0 * s.period
        elif self.step in (Step.DONE, Step.OPEN):
            self.flow = 0.0
        else:
            self.flow += max(-change, min(change, self.wanted() - self.flow))
        speed = Float32()
        speed.data = self.flow / s.ml_per_mm
        self.piston.publish(speed)
        self.valve.publish(Bool(data=self.step == Step.FLUSH))
        state = String()
        state.data = self.step.value
        self.state.publish(state)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(ContrastInjector())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
