#!/usr/bin/env python3
"""Counts bundles of banknotes: a feeder draws them one by one, a gauge measures each, two at a time are diverted.

The operator feeds diverted notes again. The bundle is done when the hopper is empty.
"""

from collections import Counter
from dataclasses import dataclass, field

import rclpy
from geometry_msgs.msg import Vector3
from rclpy.node import Node
from std_msgs.msg import Bool, Empty, Int32, String

THINNEST = 0.04  # mm, less is a hole or a missed draw
DOUBLE = 0.19  # mm
LENGTHS = (118.0, 170.0)  # mm
MOST_SKEW = 0.25  # rad


@dataclass
class Bundle:
    """What has passed of a bundle."""

    counted: int = 0
    diverted: int = 0
    reasons: Counter = field(default_factory=Counter)
    thickness: float = 0.0  # mm, of the mean note

    def note(self, thickness):
        self.counted += 1
        self.thickness += (thickness - self.thickness) / self.counted

    def divert(self, reason):
        self.diverted += 1
        self.reasons[reason] += 1


def reject_reason(thickness, length, skew):
    """Return why a note must be diverted, or None."""
    if thickness > DOUBLE:
        return "double"
    if not LENGTHS[0] <= length <= LENGTHS[1]:
        return "length"
    if abs(skew) > MOST_SKEW:
        return "skew"
    return None


class BanknoteFeeder(Node):
    IDLE, FEED, PAUSE, DONE = range(4)

    def __init__(self):
        super().__init__("banknote_feeder")
        self.pause = self.declare_parameter("pause_after_divert", 0.4).value  # s
        self.most_diverted = self.declare_parameter("most_diverted", 8).value
        self.empty_after = self.declare_parameter("empty_after", 1.0).value  # s
        self.mode = self.IDLE
        self.since = self.seconds()
        self.bundle = Bundle()
        self.hopper = False
        self.feed_pub = self.create_publisher(Bool, "feeder/run", 1)
        self.divert_pub = self.create_publisher(Empty, "diverter/flip", 1)
        self.count_pub = self.create_publisher(Int32, "bundle/count", 1)
        self.alarm_pub = self.create_publisher(String, "feeder/alarm", 1)
        self.display_pub = self.create_publisher(String, "feeder/display", 1)
        self.create_subscription(Vector3, "gauge/note", self.on_note, 10)
        self.create_subscription(Bool, "hopper/full", self.on_hopper, 5)
        self.create_timer(0.1, self.tick)
        self.create_timer(3.0, self.display)

    def seconds(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def switch(self, mode):
        self.mode = mode
        self.since = self.seconds()

    def on_hopper(self, msg):
        if msg.data and self.mode in (self.IDLE, self.DONE):
            self.bundle = Bundle()
            self.switch(self.FEED)
        elif self.hopper and not msg.data:
            self.since = self.seconds()
        self.hopper = msg.data

    def on_note(self, msg):
        """Take one note: x is its thickness in mm, y its length in mm, z its skew in rad."""
        if self.mode not in (self.FEED, self.PAUSE):
            self.get_logger().warning("note without feeding")
            return
        if msg.x < THINNEST:
            return
        reason = reject_reason(msg.x, msg.y, msg.z)
        if reason is None:
            self.bundle.note(msg.x)
            return
        self.bundle.divert(reason)
        self.divert_pub.publish(Empty())
        if self.bundle.diverted > self.most_diverted:
            self.alarm_pub.publish(String(data=f"{dict(self.bundle.reasons)}"))
            self.switch(self.IDLE)
        else:
            self.switch(self.PAUSE)

    def tick(self):
        spent = self.seconds() - self.since
        if self.mode == self.PAUSE and spent >= self.pause:
            self.switch(self.FEED)
        elif self.mode == self.FEED and not self.hopper and spent >= self.empty_after:
            self.count_pub.publish(Int32(data=self.bundle.counted))
            self.switch(self.DONE)
        self.feed_pub.publish(Bool(data=self.mode == self.FEED))

    def display(self):
        bundle = self.bundle
        text = f"{bundle.counted} notes of {bundle.thickness:.3f} mm, {bundle.diverted} diverted"
        self.display_pub.publish(String(data=text))


def main(args=None):
    rclpy.init(args=args)
    feeder = BanknoteFeeder()
    try:
        rclpy.spin(feeder)
    except KeyboardInterrupt:
        pass
    feeder.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
