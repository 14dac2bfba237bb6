#!/usr/bin/env python
"""Dips a rack of wicks into a bath of wax, again and again, until its candles have their weight.

The load cell hangs above the rack. Its reading counts only while the rack is out of the bath and no longer drips.
"""

import rospy
from sensor_msgs.msg import Temperature
from std_msgs.msg import Empty, Float32, String

ON_TOP = 0.01  # m


class CandleDipper(object):
    def __init__(self):
        hoist = rospy.get_param("~hoist")
        dip = rospy.get_param("~dip")
        candle = rospy.get_param("~candle")
        self.lower_speed = hoist["lower_speed"]
        self.raise_speed = hoist["raise_speed"]
        self.depth = hoist["depth"]
        self.dwell = dip["dwell"]
        self.cool = dip["cool"]
        self.max_dips = dip["max_dips"]
        self.weight = candle["weight"]
        self.wick = candle["wick"]

        self.state = "idle"
        self.entered = rospy.get_time()
        self.position = 0.0
        self.load = None
        self.bath = None
        self.dips = 0
        self.hoist_pub = rospy.Publisher("hoist/speed", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("dipper/state", String, queue_size=1)
        rospy.Subscriber("hoist/position", Float32, self.position_cb)
        rospy.Subscriber("rack/load", Float32, self.load_cb)
        rospy.Subscriber("bath/temperature", Temperature, self.bath_cb)
        rospy.Subscriber("line/rack_hung", Empty, self.hung_cb)
        rospy.Timer(rospy.Duration(0.5), self.tick)

    def position_cb(self, msg):
        self.position = msg.data

    def load_cb(self, msg):
        self.load = msg.data if self.load is None else 0.5 * self.load + 0.5 * msg.data

    def bath_cb(self, msg):
        self.bath = msg.temperature

    def hung_cb(self, _):
        if self.state == "idle":
            rospy.loginfo("new rack, bath at %s degrees", self.bath)
            self.dips = 0
            self.go("lower")

    def go(self, state):
        self.state = state
        self.entered = rospy.get_time()

    def waited(self):
        return rospy.get_time() - self.entered

    def heavy_enough(self):
        return self.load is not None and self.load - self.wick >= self.weight

    def tick(self, event):
        speed = 0.0
        if self.state == "lower":
            speed = self.lower_speed
            if self.position >= self.depth:
                self.dips += 1
                self.go("dwell")
        elif self.state == "dwell":
            if self.waited() >= self.dwell:
                self.go("raise")
        elif self.state == "raise":
            speed = -self.raise_speed
            if self.position <= ON_TOP:
                self.go("cool")
        elif self.state == "cool" and self.waited() >= self.cool:
            if self.heavy_enough():
                self.go("done")
            elif self.dips >= self.max_dips:
                rospy.logerr("%d dips, %.1f g", self.dips, self.load)
                self.go("failed")
            else:
                self.go("lower")
        if self.state in ("dwell", "cool", "done", "failed"):
            speed = 0.0
        self.hoist_pub.publish(speed)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("candle_dipper")
    CandleDipper()
    rospy.spin()
