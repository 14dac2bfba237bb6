#!/usr/bin/env python
"""Carries tools and a ladder along a corridor of the works, from one door to the next."""

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float32, String


class Runner(object):
    def __init__(self):
        self.v_max = rospy.get_param("~v_max", 1.0)
        self.accel = rospy.get_param("~accel", 0.5)
        self.brake = rospy.get_param("~brake", 1.2)
        self.k_stop = rospy.get_param("~k_stop", 0.8)
        self.k_side = rospy.get_param("~k_side", 0.9)
        self.k_yaw = rospy.get_param("~k_yaw", 1.4)
        self.arrived = rospy.get_param("~arrived", 0.06)
        self.patience = rospy.get_param("~patience", 3.0)  # s until it asks people to step aside
        self.goal = None
        self.x = self.y = self.yaw = 0.0
        self.limit = 0.0
        self.limit_time = None
        self.v = 0.0
        self.blocked_since = None
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.voice = rospy.Publisher("voice/say", String, queue_size=1)
        self.there = rospy.Publisher("runner/there", Bool, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.odom_cb)
        rospy.Subscriber("guard/limit", Float32, self.limit_cb)
        rospy.Subscriber("runner/goal", Float32, self.goal_cb)
        rospy.Timer(rospy.Duration(0.05), self.drive)

    def odom_cb(self, msg):
        self.x = msg.pose.pose.position.x
        self.y = msg.pose.pose.position.y
        self.yaw = 2.0 * msg.pose.pose.orientation.z  # small angles

    def limit_cb(self, msg):
        self.limit = msg.data
        self.limit_time = rospy.get_time()

    def goal_cb(self, msg):
        self.goal = msg.data

    def drive(self, event):
        now = rospy.get_time()
        cmd = Twist()
        if self.goal is None or self.limit_time is None or now - self.limit_time > 0.5:
            self.v = 0.0
            self.cmd.publish(cmd)
            return
        left = self.goal - self.x
        wish = min(self.v_max, self.limit, max(0.0, self.k_stop * left))
        if abs(left) < self.arrived:
            wish = 0.0
        self.v += max(-self.brake * 0.05, min(self.accel * 0.05, wish - self.v))
        if self.limit < 0.05 and left > 0.5:
            if self.blocked_since is None:
                self.blocked_since = now
            elif now - self.blocked_since > self.patience:
                self.voice.publish("may I pass, please")
                self.blocked_since = now
        else:
            self.blocked_since = None
        cmd.linear.x = self.v
        if self.v > 0.05:
            cmd.angular.z = -self.k_side * self.y - self.k_yaw * self.yaw
        self.cmd.publish(cmd)
        self.there.publish(abs(left) < self.arrived and self.v < 0.03)


if __name__ == "__main__":
    rospy.init_node("runner")
    Runner()
    rospy.spin()
