#!/usr/bin/env python3
import os
import sys
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "src"))
import rospy
from geometry_msgs.msg import Twist, PoseStamped
from std_msgs.msg import Float64
from nav import OdomMixin, Limiter
import nav.core as core


class Goto(OdomMixin, object):
    def __init__(self):
        self.limit = Limiter()
        self.goal = None
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.conf = rospy.Publisher("limit", Float64, queue_size=1)
        self.errs = rospy.Publisher("err", Float64, queue_size=1)
        self.init_odom()
        rospy.Subscriber("goal", PoseStamped, self.on_goal)  # source goal

    def on_goal(self, m):
        self.goal = m.pose.position

    def on_pose(self, pose):
        if self.goal is None:
            return
        t = Twist()
        t.linear.x = self.goal.x - pose.position.x
        t.linear.y = self.goal.y
        self.cmd.publish(self.limit(t))  # sink odom goal
        self.conf.publish(core.settings["limits"]["v"])  # clean
        self.conf.publish(self.limit.v)  # clean
        self.errs.publish(self.twist.linear.x)  # sink odom


if __name__ == "__main__":
    rospy.init_node("goto")
    Goto()
    rospy.spin()
