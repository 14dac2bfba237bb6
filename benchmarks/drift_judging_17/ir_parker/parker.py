#!/usr/bin/env python
"""Parks a cleaning robot in front of a wall, at the distance that the cleaning head asks for."""

from collections import deque

import ranger
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float32, UInt16


class Parker:
    def __init__(self):
        self.kp = rospy.get_param("~kp", 0.9)
        self.max_speed = rospy.get_param("~max_speed", 0.22)
        self.min_speed = rospy.get_param("~min_speed", 0.02)
        self.tolerance = rospy.get_param("~tolerance", 0.012)
        self.hold = rospy.get_param("~hold", 8)
        self.raws = deque(maxlen=5)
        self.goal = None
        self.settled = 0
        self.speed = 0.0
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.there = rospy.Publisher("parker/there", Bool, queue_size=1)
        rospy.Subscriber("adc/a3", UInt16, self.adc_cb)
        rospy.Subscriber("head/wanted_distance", Float32, self.goal_cb)
        rospy.Timer(rospy.Duration(0.1), self.control)

    def adc_cb(self, msg):
        self.raws.append(msg.data)

    def goal_cb(self, msg):
        if msg.data != self.goal:
            self.goal = msg.data
            self.settled = 0

    def control(self, event):
        cmd = Twist()
        if self.goal is None or len(self.raws) < 3:
            self.pub.publish(cmd)
            return
        error = ranger.metres(ranger.median(self.raws)) - self.goal
        if abs(error) < self.tolerance:
            self.settled += 1
            self.speed = 0.0
        else:
            self.settled = max(0, self.settled - 1)
            want = self.kp * error
            want = max(-0.15, min(self.max_speed, want))
            if abs(want) < self.min_speed:
                want = self.min_speed if want > 0 else -self.min_speed
            step = max(-0.06, min(0.03, want - self.speed))
            self.speed += step
        cmd.linear.x = self.speed
        self.pub.publish(cmd)
        self.there.publish(self.settled >= self.hold)


if __name__ == "__main__":
    rospy.init_node("parker")
    Parker()
    rospy.spin()
