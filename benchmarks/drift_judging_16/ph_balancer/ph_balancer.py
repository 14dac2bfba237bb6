#!/usr/bin/env python3
"""Keeps the pH of a nutrient solution for lettuce with doses of acid."""

import statistics
from collections import deque

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float32, String

PROBE_RANGE = (3.5, 9.5)
FLOW = 1.2  # flow of the dosing pump (ml/s)


class PhBalancer(Node):
    def __init__(self):
        super().__init__("ph_balancer")
        self.target = self.declare_parameter("target", 5.9).value
        self.gain = self.declare_parameter("ml_per_ph", 22.0).value
        self.deadband = self.declare_parameter("deadband", 0.04).value
        self.max_dose = self.declare_parameter("max_dose", 70.0).value
        self.mixing = self.declare_parameter("mixing_time", 60.0).value
        self.daily_limit = self.declare_parameter("daily_limit", 2500.0).value
        self.ec_alarm = self.declare_parameter("ec_alarm", 2.8).value
        self.probe = deque(maxlen=9)
        self.ec = 1.2
        self.total = 0.0
        self.pump_until = None
        self.pump = self.create_publisher(Float32, "acid_pump/flow", 1)
        self.alarm = self.create_publisher(String, "balancer/alarm", 1)
        self.create_subscription(Float32, "tank/ph", self.ph_received, 5)
        self.create_subscription(Float32, "tank/ec", self.ec_received, 5)
        self.create_timer(self.mixing, self.dose)
        self.create_timer(1.0, self.run_pump)

    def ph_received(self, msg):
        low, high = PROBE_RANGE
        if low < msg.data < high:
            self.probe.append(msg.data)

    def ec_received(self, msg):
        self.ec = 0.9 * self.ec + 0.1 * msg.data
        if self.ec > self.ec_alarm:
            self.alarm.publish(String(data=f"salts at {self.ec:.1f} mS/cm"))

    def seconds(self):
        return self.get_clock().now().nanoseconds / 1e9

    def dose(self):
        if len(self.probe) < 5:
            return
        excess = statistics.median(self.probe) - self.target
        if excess < self.deadband:
            return
        ml = min(self.gain * excess, self.max_dose)
        if self.total + ml > self.daily_limit:
            self.alarm.publish(String(data="no acid left for today"))
            return
        self.total += ml
        self.pump_until = self.seconds() + ml / FLOW

    def run_pump(self):
        running = self.pump_until is not None and self.seconds() < self.pump_until
        self.pump.publish(Float32(data=FLOW if running else 0.0))


def main(args=None):
    rclpy.init(args=args)
    balancer = PhBalancer()
    try:
        rclpy.spin(balancer)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    else:
        balancer.destroy_node()


if __name__ == "__main__":
    main()
