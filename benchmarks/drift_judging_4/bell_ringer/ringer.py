#!/usr/bin/env python
# -*- coding: utf-8 -*-
"""Ring n strokes of a ship's bell: pull the rope in time with its swing, then let it come to rest."""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

PERIOD = 1.6  # time from pull to pull (s)
PULL = 0.5  # time for which the rope is under load (s)
FIRST = 1.25  # factor of the first pulls, which start a bell at rest
FIRST_PULLS = 3


def make_ringer():
    """Return the functions (ring, count), which share the state of the ringer."""
    told = {"strokes": 0, "wanted": None, "angle": 0.0, "silent": False}

    rope = rospy.Publisher("rope/pull", Float32, queue_size=1, latch=True)
    status = rospy.Publisher("ringer/status", String, queue_size=1)
    done = rospy.Publisher("ringer/done", Bool, queue_size=1, latch=True)

    def on_order(msg):
        if told["wanted"] is None:
            told["wanted"] = msg.data
            rospy.loginfo("ring %d strokes", msg.data)

    def on_stroke(msg):
        told["strokes"] = msg.data

    def on_silence(msg):
        told["silent"] = msg.data

    rospy.Subscriber("ringer/order", Int32, on_order)
    rospy.Subscriber("bell/strokes", Int32, on_stroke)
    rospy.Subscriber("harbour/silence", Bool, on_silence)

    def enough():
        return told["silent"] or told["strokes"] >= told["wanted"]

    def strength(pulls):
        """Publish a share of the motor's force."""
        return 0.8 * FIRST if pulls < FIRST_PULLS else 0.8

    def pull_once(pulls):
        rope.publish(strength(pulls))
        rospy.sleep(PULL)
        rope.publish(0.0)
        status.publish("pull %d" % pulls)

    def ring():
        """Repeat: pull and wait for the rest of the period."""
        pulls = 0
        while not rospy.is_shutdown() and not enough():
            pull_once(pulls)
            pulls += 1
            rospy.sleep(PERIOD - PULL)
        rope.publish(0.0)
        done.publish(True)

    def ready():
        return told["wanted"] is not None

    return ring, ready


def main():
    rospy.init_node("ringer")
    ring, ready = make_ringer()
    while not rospy.is_shutdown() and not ready():
        rospy.sleep(0.02)
    ring()
    rospy.spin()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
