#!/usr/bin/env python3
"""Coin acceptor of a ticket machine.

A coin rolls past a light barrier (diameter), a coil (conductivity, counted as damping) and a piezo (how hard it
lands, which goes with its weight). The nearest entry of the table wins; a coin that is near to no entry is
given back.
"""

from functools import partial
from typing import NamedTuple

import rclpy
from std_msgs.msg import Bool, Float32, Int32


class Coin(NamedTuple):
    name: str
    cents: int
    diameter: float  # mm
    damping: float  # counts
    thud: float  # counts


TABLE = (
    Coin("50 cent", 50, 24.25, 410.0, 78.0),
    Coin("1 euro", 100, 23.25, 265.0, 75.0),
    Coin("2 euro", 200, 25.75, 318.0, 85.0),
)
SCALE = {"diameter": 0.35, "damping": 14.0, "thud": 5.0}  # difference that counts as one unit of distance
ACCEPT = 3.2  # units


class Acceptor:
    def __init__(self, node):
        self.node = node
        self.seen = {}
        self.credit = 0
        self.flap = node.create_publisher(Bool, "flap/accept", 5)
        self.credit_pub = node.create_publisher(Int32, "till/credit", 5)
        for what in SCALE:
            node.create_subscription(Float32, f"coin/{what}", partial(self.on_reading, what), 5)

    def on_reading(self, what, msg):
        """Collect the readings of one coin; the piezo is the last."""
        self.seen[what] = msg.data
        if what == "thud" and len(self.seen) == len(SCALE):
            self.decide()
            self.seen = {}

    def distance(self, coin):
        parts = [(self.seen[what] - getattr(coin, what)) / SCALE[what] for what in SCALE]
        return sum(part * part for part in parts) ** 0.5

    def decide(self):
        best = min(TABLE, key=self.distance)
        good = self.distance(best) < ACCEPT
        if good:
            self.credit += best.cents
            self.node.get_logger().debug(f"{best.name}, {self.credit} cents")
        self.flap.publish(Bool(data=bool(good)))
        self.credit_pub.publish(Int32(data=self.credit))


def main():
    rclpy.init()
    node = rclpy.create_node("acceptor")
    Acceptor(node)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
