#!/usr/bin/env python
"""Overhead crane: carry a load to a goal with a two-step speed profile that leaves no sway."""

import math

import rospy
from std_msgs.msg import Float32

HALF_PERIOD = 1.003  # time of half a swing with a rope of 1 m (s)
V = 0.8  # m/s
DRIVE_LAG = 0.15  # s


class OverheadCrane(object):
    def __init__(self):
        self.goal = None
        self.x = None
        self.rope = 5.0
        self.phase = "idle"
        self.t0 = None
        self.pub = rospy.Publisher("crane/speed", Float32, queue_size=1)
        rospy.Subscriber("crane/position", Float32, self.on_position)
        rospy.Subscriber("crane/hoist", Float32, self.on_hoist)
        rospy.Subscriber("crane/goal", Float32, self.on_goal)

    def on_goal(self, msg):
        if self.phase == "idle":
            self.goal = msg.data
            self.phase = "start"
            self.t0 = rospy.Time.now()

    def on_hoist(self, msg):
        self.rope = msg.data

    def on_position(self, msg):
        self.x = msg.data

    def half(self):
        # the second step cancels the sway of the first
        return HALF_PERIOD * math.sqrt(self.rope)

    def step(self):
        if self.goal is None or self.x is None:
            return
        now = rospy.Time.now()
        elapsed = (now - self.t0).to_sec()
        remaining = self.goal - self.x
        speed = 0.0
        if self.phase == "start":
            speed = V / 2
            if elapsed > self.half() - 0.05:
                self.phase = "travel"
        if self.phase == "travel":
            speed = V
            if remaining < V / 2 * self.half() + V * DRIVE_LAG:
                self.phase = "brake"
                self.t0, elapsed = now, 0.0
        if self.phase == "brake":
            speed = V / 2
            if elapsed > self.half() - 0.05:
                self.phase = "done"
                speed = 0.0
        self.pub.publish(speed)


if __name__ == "__main__":
    rospy.init_node("overhead_crane")
    crane = OverheadCrane()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        crane.step()
        rate.sleep()
