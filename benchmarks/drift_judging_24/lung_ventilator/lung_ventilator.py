#!/usr/bin/env python3
"""Pressure support for a patient who breathes on his own, with a mask.

A breath begins when the patient draws air, and ends when the flow has dropped to a part of its peak. Without any effort
of the patient, a backup breath comes. Flows are in litres per minute, pressures in cmH2O.
"""

from enum import Enum

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, String, UInt32


class Phase(Enum):
    INSPIRATION = "inspiration"
    EXPIRATION = "expiration"


class LungVentilator(Node):
    PERIOD = 0.05

    def __init__(self):
        super().__init__("lung_ventilator")
        self.declare_parameter("peep", 5.0)
        self.declare_parameter("support", 10.0)
        self.declare_parameter("rise_time", 0.15)
        self.declare_parameter("trigger_flow", 2.0)
        self.declare_parameter("cycle_off", 0.3)
        self.declare_parameter("max_inspiration", 1.3)
        self.declare_parameter("min_expiration", 0.45)
        self.declare_parameter("backup_after", 6.0)
        self.declare_parameter("pressure_alarm", 30.0)
        self.phase = Phase.EXPIRATION
        self.changed = self.now()
        self.flow = 0.0
        self.peak = 0.0
        self.pressure = 0.0
        self.breaths = 0
        self.target_pub = self.create_publisher(Float32, "blower/pressure", 1)
        self.phase_pub = self.create_publisher(String, "ventilator/phase", 1)
        self.count_pub = self.create_publisher(UInt32, "ventilator/breaths", 1)
        self.create_subscription(Float32, "circuit/flow", self.on_flow, 5)
        self.create_subscription(Float32, "circuit/pressure", self.on_pressure, 5)
        self.create_timer(self.PERIOD, self.control)
        self.create_timer(5.0, self.count)

    def value(self, name):
        return self.get_parameter(name).get_parameter_value().double_value

    def now(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_flow(self, msg):
        self.flow = msg.data

    def on_pressure(self, msg):
        self.pressure = msg.data
        if msg.data > self.value("pressure_alarm"):
            self.get_logger().warning(f"high pressure: {msg.data:.1f}")
            self.switch(Phase.EXPIRATION)

    def switch(self, phase):
        if phase is self.phase:
            return
        self.phase = phase
        self.changed = self.now()
        self.peak = 0.0
        if phase is Phase.INSPIRATION:
            self.breaths += 1

    def triggered(self, elapsed):
        if elapsed < self.value("min_expiration"):
            return False
        if elapsed > self.value("backup_after"):
            self.get_logger().info("backup breath")
            return True
        return self.flow > self.value("trigger_flow")

    def exhausted(self, elapsed):
        """Return whether the patient has breathed in."""
        self.peak = max(self.peak, self.flow)
        if elapsed > self.value("max_inspiration"):
            return True
        return elapsed > self.value("rise_time") and self.flow < self.value("cycle_off") * self.peak

    def target(self):
        pressure = self.value("peep")
        if self.phase is Phase.INSPIRATION:
            part = min(1.0, (self.now() - self.changed) / self.value("rise_time"))
            pressure += part * self.value("support")
        return pressure

    def control(self):
        elapsed = self.now() - self.changed
        if self.phase is Phase.EXPIRATION:
            if self.triggered(elapsed):
                self.switch(Phase.INSPIRATION)
        elif self.exhausted(elapsed):
            self.switch(Phase.EXPIRATION)
        self.target_pub.publish(Float32(data=self.target()))
        self.phase_pub.publish(String(data=self.phase.value))

    def count(self):
        self.count_pub.publish(UInt32(data=self.breaths))


def main(args=None):
    rclpy.init(args=args)
    node = LungVentilator()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
