#!/usr/bin/env python
"""Autopilot of a small sailing boat: steers to a mark on one tack, and trims the sheet by the wind vane."""

import math

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Float32, String

NO_GO = 0.66  # rad off the wind, closer the sails flap


def wrap(a):
    return math.atan2(math.sin(a), math.cos(a))


def clamp(v, low, high):
    return max(low, min(high, v))


class SailTrimmer(object):
    def __init__(self):
        self.vane_share = rospy.get_param("~vane_share", 0.25)
        self.vane_offset = rospy.get_param("~vane_offset", 0.0)  # rad, mounting
        self.boom_rate = rospy.get_param("~boom_rate", 0.62)  # boom angle per angle of the wind
        self.boom_start = rospy.get_param("~boom_start", 0.32)
        self.boom_min = rospy.get_param("~boom_min", 0.1)
        self.boom_max = rospy.get_param("~boom_max", 1.35)
        self.heel_limit = rospy.get_param("~heel_limit", 0.45)
        self.ease = rospy.get_param("~ease", 0.9)  # boom angle per rad of heel above the limit
        self.k_heading = rospy.get_param("~k_heading", 1.1)
        self.k_rate = rospy.get_param("~k_rate", 0.5)
        self.rudder_max = rospy.get_param("~rudder_max", 0.6)
        self.near = rospy.get_param("~near", 6.0)  # m
        self.wind = None
        self.heading = None
        self.last_heading = None
        self.turning = 0.0
        self.heel = 0.0
        self.position = None
        self.mark = None
        self.sheet_pub = rospy.Publisher("boom/angle", Float32, queue_size=1)
        self.rudder_pub = rospy.Publisher("rudder/angle", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("autopilot/state", String, queue_size=1)
        rospy.Subscriber("wind/angle", Float32, self.wind_cb)
        rospy.Subscriber("compass", Float32, self.compass_cb)
        rospy.Subscriber("heel", Float32, self.heel_cb)
        rospy.Subscriber("gps/local", Point, self.gps_cb)
        rospy.Subscriber("mark", Point, self.mark_cb)
        rospy.Timer(rospy.Duration(0.25), self.steer)

    def wind_cb(self, msg):
        angle = wrap(msg.data + self.vane_offset)
        if self.wind is None:
            self.wind = angle
        self.wind = wrap(self.wind + self.vane_share * wrap(angle - self.wind))

    def compass_cb(self, msg):
        if self.heading is not None:
            rate = wrap(msg.data - self.heading) / 0.25
            self.turning += 0.3 * (rate - self.turning)
        self.heading = msg.data

    def heel_cb(self, msg):
        self.heel = abs(msg.data)

    def gps_cb(self, msg):
        self.position = msg

    def mark_cb(self, msg):
        self.mark = msg

    def boom_for(self, wind):
        boom = self.boom_rate * (abs(wind) - self.boom_start)
        if self.heel > self.heel_limit:
            boom += self.ease * (self.heel - self.heel_limit)
        return clamp(boom, self.boom_min, self.boom_max)

    def steer(self, event):
        if None in (self.wind, self.heading, self.position, self.mark):
            return
        dx = self.mark.x - self.position.x
        dy = self.mark.y - self.position.y
        course = math.atan2(dy, dx)
        state = "there" if math.hypot(dx, dy) < self.near else "sailing"
        error = wrap(course - self.heading)
        if abs(self.wind) < NO_GO and error * self.wind > 0.0:
            error = 0.0  # do not turn into the wind
            state = "pinching"
        rudder = self.k_heading * error - self.k_rate * self.turning
        self.sheet_pub.publish(self.boom_for(self.wind))
        self.rudder_pub.publish(clamp(rudder, -self.rudder_max, self.rudder_max))
        self.state_pub.publish(state)


if __name__ == "__main__":
    rospy.init_node("sail_trimmer")
    SailTrimmer()
    rospy.spin()
