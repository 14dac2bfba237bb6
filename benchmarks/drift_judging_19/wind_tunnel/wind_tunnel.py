#!/usr/bin/env python
"""Calibrates anemometers: runs the fan of a small wind tunnel to a list of air speeds and holds each of them."""

import math

import rospy
from std_msgs.msg import Bool, Float32, String
from tunnel_settings import Settings


class WindTunnel(object):
    def __init__(self, settings):
        self.s = settings
        self.dp = 0.0
        self.hpa = None
        self.kelvin = 293.0
        self.goals = []
        self.step = 0
        self.integral = 0.0
        self.fan = 0.0
        self.in_band = 0
        self.held = 0
        self.fan_pub = rospy.Publisher("fan/drive", Float32, queue_size=1)
        self.speed_pub = rospy.Publisher("tunnel/speed", Float32, queue_size=1)
        self.hold_pub = rospy.Publisher("tunnel/hold", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("tunnel/state", String, queue_size=1)
        rospy.Subscriber("pitot/pascal", Float32, self.pitot_cb)
        rospy.Subscriber("room/hpa", Float32, self.baro_cb)
        rospy.Subscriber("job/speeds", String, self.job_cb)
        rospy.Timer(rospy.Duration(self.s.period), self.control)

    def pitot_cb(self, msg):
        self.dp += self.s.dp_share * (msg.data - self.dp)

    def baro_cb(self, msg):
        if self.hpa is None:
            rospy.loginfo("barometer reads %.0f hPa, for the certificate", msg.data)
        self.hpa = msg.data

    def job_cb(self, msg):
        if not self.goals:
            self.goals = [float(word) for word in msg.data.split()]

    def air_speed(self):
        return math.sqrt(max(0.0, 2.0 * self.dp / self.s.density))

    def control(self, event):
        if not self.goals or self.hpa is None:
            return
        s = self.s
        done = self.step >= len(self.goals)
        goal = 0.0 if done else self.goals[self.step]
        speed = self.air_speed()
        error = goal - speed
        if abs(error) < 3.0:
            self.integral += s.ki * error * s.period
            self.integral = max(-s.trim_max, min(s.trim_max, self.integral))
        wish = s.drive_per_speed * goal + s.kp * error + self.integral
        self.fan += max(-s.slew, min(s.slew, wish - self.fan))
        self.fan = max(0.0, min(1.0, self.fan))
        self.in_band = self.in_band + 1 if abs(error) < s.band * max(goal, 1.0) else 0
        hold = self.in_band >= s.settle_count and not done
        self.held = self.held + 1 if hold else 0
        if self.held >= s.hold_count:
            self.step += 1
            self.in_band = self.held = 0
        self.fan_pub.publish(0.0 if done else self.fan)
        self.speed_pub.publish(speed)
        self.hold_pub.publish(hold)
        self.state_pub.publish("done" if done else "hold" if hold else "settle")


if __name__ == "__main__":
    rospy.init_node("wind_tunnel")
    WindTunnel(Settings())
    rospy.spin()
