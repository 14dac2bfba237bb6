#!/usr/bin/env python
"""Fence post driver on a tractor: sets up the mast, hammers each post down to its depth, and moves on.

A post that meets rock is left as it is and reported, so that the crew can cut or drill it.
"""

import rospy
from geometry_msgs.msg import Vector3
from refusal import RefusalGauge
from std_msgs.msg import Empty, Float32, String

SEATING = 3  # light blows before the mast lets go of the post
TILT_OK = 0.015  # rad


class PostDriver(object):
    def __init__(self):
        self.depth_wanted = rospy.get_param("~depth", 0.75)  # m
        self.energy = rospy.get_param("~energy", 0.8)  # kJ per blow
        self.soft = rospy.get_param("~seating_energy", 0.25)
        self.period = rospy.get_param("~period", 0.8)  # s between two blows
        self.plumb_gain = rospy.get_param("~plumb_gain", 0.5)
        self.gauge = RefusalGauge()
        self.phase = "wait"
        self.blows = 0
        self.depth = 0.0
        self.last_depth = None
        self.tilt = None
        self.results = []
        self.strike_pub = rospy.Publisher("hammer/strike", Float32, queue_size=1)
        self.mast_pub = rospy.Publisher("mast/correction", Vector3, queue_size=1)
        self.result_pub = rospy.Publisher("driver/result", String, queue_size=1)
        rospy.Subscriber("hammer/depth", Float32, self.on_depth)
        rospy.Subscriber("mast/tilt", Vector3, self.on_tilt)
        rospy.Subscriber("tractor/in_place", Empty, self.on_place)
        rospy.Timer(rospy.Duration(self.period), self.work)

    def on_depth(self, msg):
        self.depth = msg.data

    def on_tilt(self, msg):
        self.tilt = msg

    def on_place(self, _):
        if self.phase != "wait":
            rospy.logwarn("the tractor moved during %s", self.phase)
        self.phase = "plumb"
        self.blows = 0
        self.last_depth = None
        self.gauge.reset()

    def finish(self, result):
        rospy.loginfo(
            "post %d: %s at %.2f m after %d blows", len(self.results) + 1, result, self.depth, self.blows
        )
        self.results.append(result)
        self.result_pub.publish(result)
        self.phase = "wait"

    def plumb(self):
        if self.tilt is None:
            return
        if max(abs(self.tilt.x), abs(self.tilt.y)) < TILT_OK:
            self.phase = "drive"
            return
        self.mast_pub.publish(Vector3(-self.plumb_gain * self.tilt.x, -self.plumb_gain * self.tilt.y, 0.0))

    def drive(self):
        if self.last_depth is not None and self.blows > SEATING:
            self.gauge.add(1000.0 * (self.depth - self.last_depth))
        if self.depth >= self.depth_wanted:
            self.finish("driven")
        elif self.gauge.refused():
            self.finish("refused")
        else:
            self.last_depth = self.depth
            self.strike_pub.publish(self.soft if self.blows < SEATING else self.energy)
            self.blows += 1

    def work(self, event):
        if self.phase == "plumb":
            self.plumb()
        elif self.phase == "drive":
            self.drive()


if __name__ == "__main__":
    rospy.init_node("post_driver")
    PostDriver()
    rospy.spin()
