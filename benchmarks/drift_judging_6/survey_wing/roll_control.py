#!/usr/bin/env python3
"""Inner loop of a small survey aircraft: hold the bank angle that the navigator requests."""

import math

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.node import Node
from std_msgs.msg import Float32


def wrap(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


class RollControl(Node):
    """An angle loop around a rate loop, whose output is the deflection of the ailerons in rad."""

    MAX_BANK = 0.7
    MAX_RATE = 1.2
    MAX_DEFLECTION = 0.45

    def __init__(self) -> None:
        super().__init__("roll_control")
        self._angle_gain = self.declare_parameter("angle_gain", 2.5).value
        self._rate_gain = self.declare_parameter("rate_gain", 0.40).value
        self._feed_forward = self.declare_parameter("feed_forward", 0.08).value
        self._bank_wanted = 0.0
        self._attitude_seen = False
        self._aileron = self.create_publisher(Float32, "actuators/aileron", 10)
        self.create_subscription(Float32, "nav/bank", self._on_bank, 10)
        self.create_subscription(Vector3Stamped, "imu/roll", self._on_roll, 10)

    def _on_bank(self, message: Float32) -> None:
        self._bank_wanted = max(-self.MAX_BANK, min(self.MAX_BANK, message.data))

    def _on_roll(self, message: Vector3Stamped) -> None:
        """Store the bank angle (x) and the roll rate (y)."""
        bank, rate = message.vector.x, message.vector.y
        if not self._attitude_seen:
            self.get_logger().info("attitude received")
            self._attitude_seen = True
        rate_wanted = self._angle_gain * wrap(self._bank_wanted - bank)
        rate_wanted = max(-self.MAX_RATE, min(self.MAX_RATE, rate_wanted))
        deflection = self._rate_gain * (rate_wanted - rate) + self._feed_forward * rate_wanted
        deflection = max(-self.MAX_DEFLECTION, min(self.MAX_DEFLECTION, deflection))
        self._aileron.publish(Float32(data=deflection))


def main() -> None:
    rclpy.init()
    node = RollControl()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
