#!/usr/bin/env python
"""Spout of a combine harvester: turns to the middle of the trailer that drives beside it, and starts the auger."""

import math

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64, UInt8

SPOUT = (1.2, 2.0)  # m, where the spout is mounted: ahead of the antenna, and to its left
MAX_TURN = 0.06  # rad per tick
SECTOR = 0.7  # rad to both sides of straight out
LINKS = {0: "direct", 1: "relay", 2: "none"}


def clamp(value, limit):
    return max(-limit, min(limit, value))


class GrainSpout:
    def __init__(self):
        self.here = None
        self.trailer = None
        self.link = 2
        self.angle = 0.0  # rad from straight out, positive to the front
        self.angle_pub = rospy.Publisher("spout/angle", Float64, queue_size=1)
        self.auger_pub = rospy.Publisher("auger/on", Bool, queue_size=1)
        rospy.Subscriber("combine/odom", Odometry, self.combine_cb)
        rospy.Subscriber("trailer/odom", Odometry, self.trailer_cb)
        rospy.Subscriber("radio/link", UInt8, self.link_cb)

    def combine_cb(self, msg):
        self.here = msg.pose.pose.position

    def trailer_cb(self, msg):
        self.trailer = msg

    def link_cb(self, msg):
        if msg.data != self.link:
            rospy.loginfo("radio: %s", LINKS.get(msg.data, "?"))
        self.link = msg.data

    def bearing(self):
        """Return the angle at which the trailer's middle is seen from the spout."""
        there = self.trailer.pose.pose.position
        ahead = there.x - self.here.x - SPOUT[0]
        aside = there.y - self.here.y - SPOUT[1]
        return math.atan2(ahead, aside)

    def step(self):
        wish = self.bearing()
        self.angle += clamp(clamp(wish, SECTOR) - self.angle, MAX_TURN)
        self.angle_pub.publish(self.angle)
        self.auger_pub.publish(abs(wish - self.angle) < 0.1 and abs(wish) < SECTOR)


def main():
    rospy.init_node("grain_spout")
    spout = GrainSpout()
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        if spout.here is not None and spout.trailer is not None:
            spout.step()
        rate.sleep()


if __name__ == "__main__":
    main()
