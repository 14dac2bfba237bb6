#!/usr/bin/env python
"""Drives onto the charging dock: line up with the beacon, come closer, press, and wait for the charger."""

import math

import rospy
from geometry_msgs.msg import PointStamped, Twist
from std_msgs.msg import Bool, String

SEARCH, APPROACH, PRESS, CHARGE, BACK_OFF, FAILED = range(6)
NAMES = ["search", "approach", "press", "charge", "back off", "failed"]


class Docker(object):
    max_tries = 3

    def __init__(self):
        self.k_turn = rospy.get_param("~k_turn", 1.8)
        self.fast = rospy.get_param("~fast", 0.25)
        self.slow = rospy.get_param("~slow", 0.05)
        self.press_at = rospy.get_param("~press_at", 0.08)
        self.press_time = rospy.get_param("~press_time", 4.0)
        self.back_time = rospy.get_param("~back_time", 2.5)
        self.state = SEARCH
        self.since = rospy.Time.now()
        self.tries = 0
        self.beacon = None
        self.charging = False
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.status = rospy.Publisher("docker/status", String, queue_size=1)
        rospy.Subscriber("dock/beacon", PointStamped, self.on_beacon)
        rospy.Subscriber("battery/charging", Bool, self.on_charging)

    def on_beacon(self, msg):
        self.beacon = (msg.point.x, msg.point.y)

    def on_charging(self, msg):
        self.charging = msg.data

    def go(self, state):
        self.state = state
        self.since = rospy.Time.now()

    def elapsed(self):
        return (rospy.Time.now() - self.since).to_sec()

    def step(self):
        cmd = Twist()
        if self.beacon is None:
            return
        distance = math.hypot(*self.beacon)
        bearing = math.atan2(self.beacon[1], self.beacon[0])
        if self.state == SEARCH:
            cmd.angular.z = max(-0.6, min(0.6, self.k_turn * bearing))
            if abs(bearing) < 0.06:
                self.go(APPROACH)
        elif self.state == APPROACH:
            cmd.linear.x = min(self.fast, self.slow + 0.4 * max(0.0, distance - self.press_at))
            cmd.angular.z = self.k_turn * bearing
            if distance < self.press_at:
                self.go(PRESS)
        elif self.state == PRESS:
            cmd.linear.x = self.slow
            if self.charging:
                self.go(CHARGE)
            elif self.elapsed() > self.press_time:
                self.tries += 1
                self.go(BACK_OFF if self.tries < self.max_tries else FAILED)
        elif self.state == CHARGE:
            if not self.charging and self.elapsed() > 1.0:
                self.go(PRESS)
        elif self.state == BACK_OFF:
            cmd.linear.x = -0.12
            if self.elapsed() > self.back_time:
                self.go(SEARCH)
        self.cmd.publish(cmd)
        self.status.publish(NAMES[self.state])


if __name__ == "__main__":
    rospy.init_node("docker")
    docker = Docker()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        docker.step()
        rate.sleep()
