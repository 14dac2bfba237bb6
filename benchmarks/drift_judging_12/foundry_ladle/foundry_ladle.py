#!/usr/bin/env python3
"""Pour iron from a tilting ladle into a row of moulds, each to its weight."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32

KG_PER_COUNT = 0.004  # scale of the load cell under the ladle (kg)
TARE = 20000  # reading for an empty ladle (counts)
MOULD = 12.0  # mass of iron in a mould (kg)
IN_FLIGHT = 0.5  # mass that still leaves the lip after the ladle starts to tilt back (kg)
SLOW_BELOW = 4.0  # missing mass below which the ladle pours slowly (kg)
FAST, SLOW, BACK = 2.4, 0.9, -6.0  # deg/s
SMOOTHING = 0.6
STARTS = 0.15  # loss of mass from which on iron is taken to flow (kg)
MIN_LEFT = 8.0  # mass of iron in the ladle below which slag flows out (kg)


class FoundryLadle(Node):
    def __init__(self):
        super().__init__("foundry_ladle")
        self.mass = None
        self.before = 0.0
        self.state = "wait"
        self.ready = False
        self.poured = 0
        self.since = 0.0
        self.tilt = self.create_publisher(Float32, "ladle/tilt_rate", 10)
        self.advance = self.create_publisher(Bool, "moulds/advance", 10)
        self.create_subscription(Int32, "ladle/cell", self.on_cell, 10)
        self.create_subscription(Bool, "moulds/ready", self.on_ready, 10)
        self.create_timer(0.2, self.on_timer)

    def now(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def kilograms(self, counts):
        return (counts - TARE) * KG_PER_COUNT

    def on_cell(self, msg):
        kg = self.kilograms(msg.data)
        if self.mass is None:
            self.mass = kg
        self.mass += SMOOTHING * (kg - self.mass)

    def on_ready(self, msg):
        self.ready = msg.data

    def enter(self, state):
        self.state = state
        self.since = self.now()

    def rate(self, missing, flowing):
        """Return how fast to tilt for the iron that is missing."""
        if not flowing:
            return FAST
        if missing < SLOW_BELOW:
            return -0.4 * SLOW if missing < 1.5 else 0.0
        return SLOW

    def pour(self):
        gone = self.before - self.mass
        missing = MOULD - gone
        if missing < IN_FLIGHT:
            self.enter("back")
            return BACK
        return self.rate(missing, gone > STARTS)

    def on_timer(self):
        if self.mass is None:
            return
        rate = 0.0
        if self.state == "wait":
            if self.ready and self.mass > MIN_LEFT:
                self.before = self.mass
                self.enter("pour")
        elif self.state == "pour":
            rate = self.pour()
        elif self.state == "back":
            rate = BACK
            if self.now() - self.since > 2.0:
                self.poured += 1
                self.get_logger().info("mould %d: %.2f kg" % (self.poured, self.before - self.mass))
                self.advance.publish(Bool(data=True))
                self.enter("index")
        elif self.state == "index" and self.now() - self.since > 1.0:
            self.enter("wait")
        self.tilt.publish(Float32(data=rate))


def main():
    rclpy.init()
    rclpy.spin(FoundryLadle())


if __name__ == "__main__":
    main()
