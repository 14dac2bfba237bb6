#!/usr/bin/env python3
"""Sorts shards of glass by colour: median of the readings of a shard, nearest reference, flap."""

import rospy
from geometry_msgs.msg import Vector3
from std_msgs.msg import Bool, Int32

REFERENCES = [
    ("clear", (0.82, 0.84, 0.80)),
    ("green", (0.30, 0.62, 0.34)),
    ("brown", (0.48, 0.30, 0.14)),
]
READINGS = 3


def median(values):
    ordered = sorted(values)
    return ordered[len(ordered) // 2]


def distance(one, other):
    return sum((a - b) ** 2 for a, b in zip(one, other))


def nearest(colour):
    best, index = 1e9, 0
    for i, (_, reference) in enumerate(REFERENCES):
        d = distance(colour, reference)
        if d < best:
            best, index = d, i
    return index


class Sorter:
    def __init__(self):
        self.readings = []
        self.flap = rospy.Publisher("sorter/flap", Int32, queue_size=1)
        rospy.Subscriber("barrier/shard", Bool, self.on_barrier)
        rospy.Subscriber("eye/colour", Vector3, self.on_colour)

    def on_barrier(self, msg):
        """Discard the last shard when the barrier is free again."""
        if not msg.data:
            self.readings = []

    def on_colour(self, msg):
        self.readings.append((msg.x, msg.y, msg.z))
        if len(self.readings) >= READINGS:
            colour = tuple(median(channel) for channel in zip(*self.readings[-READINGS:]))
            self.flap.publish(nearest(colour))


if __name__ == "__main__":
    rospy.init_node("sorter")
    Sorter()
    rospy.spin()
