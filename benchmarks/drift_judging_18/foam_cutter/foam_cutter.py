#!/usr/bin/env python
"""Hot-wire cutter for blocks of foam. Sets the voltage of the wire and the feed of the gantry for each block."""

import math

import rospy
from std_msgs.msg import Bool, Float32, String

WIRE_LENGTH = 0.82  # m, between the clamps
OHM_PER_M = 5.1  # constantan, 0.35 mm
SUPPLY_MAX = 48.0  # V


class FoamCutter(object):
    def __init__(self):
        self.idle_watts = rospy.get_param("~idle_watts", 16.0)  # holds the wire warm in air
        self.watts_per_area = rospy.get_param("~watts_per_area", 0.115)  # W per mm2/s of cut face
        self.max_feed = rospy.get_param("~max_feed", 6.0)  # mm/s
        self.min_feed = rospy.get_param("~min_feed", 1.5)
        self.face_rate = rospy.get_param("~face_rate", 380.0)  # mm2/s, what the foam bears
        self.warm_up = rospy.get_param("~warm_up", 5.0)  # s
        self.broken_below = rospy.get_param("~broken_below", 0.25)  # A
        self.overrun = rospy.get_param("~overrun", 8.0)  # mm behind the block
        self.state = "WARM"
        self.started = rospy.get_time()
        self.thickness = None
        self.length = 0.0
        self.position = 0.0
        self.amps = None
        self.low = 0
        self.feed = 0.0
        self.volts = 0.0
        self.volts_pub = rospy.Publisher("wire/volts", Float32, queue_size=1)
        self.feed_pub = rospy.Publisher("gantry/feed", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("cutter/state", String, queue_size=1)
        self.fan_pub = rospy.Publisher("extraction/fan", Bool, queue_size=1)
        rospy.Subscriber("block/thickness", Float32, self.thickness_cb)
        rospy.Subscriber("block/length", Float32, self.length_cb)
        rospy.Subscriber("gantry/position", Float32, self.position_cb)
        rospy.Subscriber("wire/amps", Float32, self.amps_cb)

    def thickness_cb(self, msg):
        # the feeler jumps on loose beads
        if self.thickness is None:
            self.thickness = msg.data
        self.thickness += 0.25 * (msg.data - self.thickness)

    def length_cb(self, msg):
        self.length = msg.data

    def position_cb(self, msg):
        self.position = msg.data

    def amps_cb(self, msg):
        self.amps = msg.data
        if self.state != "WARM" and self.amps < self.broken_below:
            self.low += 1
            if self.low > 5 and self.state != "BROKEN":
                rospy.logerr("no current through the wire, it has snapped")
                self.state = "BROKEN"
        else:
            self.low = 0

    def wanted_feed(self):
        feed = self.face_rate / max(self.thickness, 10.0)
        return max(self.min_feed, min(self.max_feed, feed))

    def wire_volts(self, watts):
        ohms = OHM_PER_M * WIRE_LENGTH
        return min(SUPPLY_MAX, math.sqrt(watts * ohms))

    def step(self):
        if self.thickness is None or not self.length:
            return
        elapsed = rospy.get_time() - self.started
        if self.state == "WARM" and elapsed > self.warm_up:
            rospy.loginfo("cutting a block of %.0f mm", self.thickness)
            self.state = "CUT"
        elif self.state == "CUT" and self.position > self.length + self.overrun:
            rospy.loginfo("block done after %.0f s", elapsed)
            self.state = "DONE"
        if self.state == "CUT":
            change = self.wanted_feed() - self.feed
            self.feed += max(-0.5, min(0.2, change))
            watts = self.idle_watts + self.watts_per_area * self.feed * self.thickness
            self.volts = self.wire_volts(watts)
        else:
            self.feed = 0.0
            self.volts = self.wire_volts(self.idle_watts) if self.state == "WARM" else 0.0
        self.volts_pub.publish(self.volts)
        self.feed_pub.publish(self.feed)
        self.state_pub.publish(self.state)
        self.fan_pub.publish(self.state == "CUT")


if __name__ == "__main__":
    rospy.init_node("foam_cutter")
    cutter = FoamCutter()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        cutter.step()
        rate.sleep()
