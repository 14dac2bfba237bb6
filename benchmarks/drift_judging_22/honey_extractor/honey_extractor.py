#!/usr/bin/env python3
"""Honey extractor: spins the combs until almost no honey runs out, then brakes and asks for the next ones."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from spin_profile import SpinProfile
from std_msgs.msg import Bool, Float32, String


class HoneyExtractor(Node):
    """Runs one load after the lid is closed."""

    def __init__(self):
        super().__init__("honey_extractor")
        self.profile = SpinProfile()
        self.min_spin = self.declare_parameter("min_spin", 12.0).value
        self.dry_flow = self.declare_parameter("dry_flow", 0.016).value
        self.started = None
        self.flow = 0.0
        self.celsius = float("nan")
        self.motor = self.create_publisher(Float32, "basket/rpm", 1)
        self.light = self.create_publisher(String, "extractor/state", 1)
        self.create_subscription(Bool, "lid/closed", self.lid_cb, 1)
        self.create_subscription(Float32, "outlet/flow", self.flow_cb, 1)
        self.create_subscription(Temperature, "comb/temperature", self.temperature_cb, 1)
        self.create_timer(0.5, self.spin_basket)

    def lid_cb(self, msg):
        if not msg.data:
            self.started = None
        elif self.started is None:
            self.started = self.now()
            self.get_logger().info(f"load of {self.celsius:.1f} degrees")

    def flow_cb(self, msg):
        self.flow += 0.4 * (msg.data - self.flow)

    def temperature_cb(self, msg):
        self.celsius = msg.temperature

    def now(self):
        return self.get_clock().now().nanoseconds / 1e9

    def spin_basket(self):
        if self.started is None:
            return
        elapsed = self.now() - self.started
        if elapsed > self.min_spin and self.flow < self.dry_flow:
            self.motor.publish(Float32(data=0.0))
            self.light.publish(String(data="empty"))
            return
        self.motor.publish(Float32(data=self.profile.target(elapsed)))
        self.light.publish(String(data="spinning"))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(HoneyExtractor())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
