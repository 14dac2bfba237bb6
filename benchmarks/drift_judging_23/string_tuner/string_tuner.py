#!/usr/bin/env python
"""Tunes the strings of a guitar on the setup bench: plucks, listens, and turns the machine head with a motor.

A string holds its pitch only if it was tightened last. A sharp string is therefore loosened below its pitch first.
"""

import math

import rospy
from std_msgs.msg import Empty, Float32, Int32, String

STRINGS = [
    # name, Hz, cents per degree of the machine head
    ("E2", 82.41, 2.7),
    ("A2", 110.00, 2.5),
    ("D3", 146.83, 2.2),
    ("G3", 196.00, 2.0),
]

UP, DOWN = 1, -1


def cents(frequency, reference):
    """Return how much sharper a frequency is than a reference, in cents."""
    return 1200.0 * math.log(frequency / reference, 2.0)


class StringTuner(object):
    def __init__(self):
        self.slack = float(rospy.get_param("~slack"))
        self.tolerance = float(rospy.get_param("~tolerance"))
        self.under = float(rospy.get_param("~under"))
        self.caution = float(rospy.get_param("~caution"))
        self.settle = rospy.Duration(rospy.get_param("~settle"))
        self.max_plucks = int(rospy.get_param("~max_plucks"))

        self.string = None
        self.direction = UP  # of the last turn
        self.plucks = 0
        self.pluck_at = None
        self.out = []
        self.select_pub = rospy.Publisher("bench/string", Int32, queue_size=1)
        self.pluck_pub = rospy.Publisher("bench/pluck", Empty, queue_size=1)
        self.turn_pub = rospy.Publisher("head/turn", Float32, queue_size=1)
        self.report_pub = rospy.Publisher("bench/report", String, queue_size=1)
        rospy.Subscriber("bench/clamped", Empty, self.clamped_cb)
        rospy.Subscriber("mic/frequency", Float32, self.heard_cb)
        self.timer = rospy.Timer(rospy.Duration(0.2), self.tick)

    def clamped_cb(self, _):
        if self.string is None:
            self.start(0)

    def start(self, string):
        self.string = string
        if string == len(STRINGS):
            self.report_pub.publish("done" if not self.out else "check " + " ".join(self.out))
            return
        self.direction = UP  # as it comes from the factory
        self.plucks = 0
        self.select_pub.publish(string)
        self.pluck_at = rospy.Time.now() + self.settle

    def tick(self, event):
        if self.pluck_at is not None and rospy.Time.now() >= self.pluck_at:
            self.pluck_at = None
            self.plucks += 1
            self.pluck_pub.publish()

    def heard_cb(self, msg):
        if self.string is None or self.string == len(STRINGS):
            return
        name, reference, _ = STRINGS[self.string]
        off = cents(msg.data, reference)
        rospy.logdebug("%s: %+.1f cents after pluck %d", name, off, self.plucks)
        if abs(off) < self.tolerance and self.direction != DOWN:
            self.start(self.string + 1)
        elif self.plucks >= self.max_plucks:
            rospy.logwarn("%s does not tune", name)
            self.out.append(name)
            self.start(self.string + 1)
        else:
            self.correct(off)

    def correct(self, off):
        """Turn the head for a string that is `off` cents sharp."""
        per_degree = STRINGS[self.string][2]
        if off < self.tolerance:
            direction = UP
            degrees = self.caution * max(-off, 0.0) / per_degree
        else:
            direction = DOWN
            degrees = (off + self.under) / per_degree
        if direction != self.direction:
            degrees += self.slack
        self.direction = direction
        self.turn_pub.publish(direction * degrees)
        self.pluck_at = rospy.Time.now() + self.settle


if __name__ == "__main__":
    rospy.init_node("string_tuner")
    StringTuner()
    rospy.spin()
