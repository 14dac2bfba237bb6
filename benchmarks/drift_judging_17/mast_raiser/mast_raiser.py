#!/usr/bin/env python
"""Raises the camera mast of an inspection robot. Stops when it jams, goes back a little and tries once more."""

import rospy
from std_msgs.msg import Bool, Float32, String


class MastRaiser(object):
    STATES = ("DOWN", "RAISE", "BACK", "UP", "LOWER", "ABORT")

    def __init__(self):
        self.top = rospy.get_param("~top", 3.8)  # m
        self.speed = rospy.get_param("~speed", 0.30)  # m/s
        self.slow = rospy.get_param("~slow", 0.10)
        self.slow_zone = rospy.get_param("~slow_zone", 0.25)
        self.jam_current = rospy.get_param("~jam_current", 3.4)  # A
        self.jam_count = rospy.get_param("~jam_count", 3)
        self.back_by = rospy.get_param("~back_by", 0.35)
        self.max_wind = rospy.get_param("~max_wind", 14.0)  # m/s
        self.retries = rospy.get_param("~retries", 1)
        self.state = "DOWN"
        self.height = 0.0
        self.current = 0.0
        self.wind = 0.0
        self.over = 0
        self.jams = 0
        self.back_to = 0.0
        self.wanted = False
        self.motor = rospy.Publisher("mast/speed", Float32, queue_size=1)
        self.status = rospy.Publisher("mast/status", String, queue_size=1)
        rospy.Subscriber("mast/height", Float32, lambda m: setattr(self, "height", m.data))
        rospy.Subscriber("mast/current", Float32, self.current_cb)
        rospy.Subscriber("weather/wind", Float32, self.wind_cb)
        rospy.Subscriber("mast/wanted", Bool, self.wanted_cb)

    def current_cb(self, msg):
        self.current = msg.data
        self.over = self.over + 1 if self.current > self.jam_current else 0

    def wind_cb(self, msg):
        self.wind = 0.95 * self.wind + 0.05 * msg.data

    def wanted_cb(self, msg):
        self.wanted = msg.data

    def jammed(self):
        return self.over >= self.jam_count

    def step(self):
        speed = 0.0
        if self.state == "DOWN":
            if self.wanted and self.wind < self.max_wind:
                self.state = "RAISE"
        elif self.state == "RAISE":
            left = self.top - self.height
            speed = self.speed if left > self.slow_zone else self.slow
            if self.jammed():
                self.jams += 1
                self.back_to = max(0.05, self.height - self.back_by)
                self.state = "BACK" if self.jams <= self.retries else "ABORT"
                speed = 0.0
            elif left < 0.02:
                self.state = "UP"
                self.jams = 0
        elif self.state == "BACK":
            speed = -self.slow
            if self.height <= self.back_to:
                self.state = "RAISE"
        elif self.state == "UP":
            if not self.wanted or self.wind > self.max_wind + 2.0:
                self.state = "LOWER"
        elif self.state == "LOWER":
            speed = -0.8 * self.speed
            if self.height < 0.03:
                self.state = "DOWN"
        self.motor.publish(speed)
        self.status.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("mast_raiser")
    mast = MastRaiser()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        mast.step()
        rate.sleep()
