#!/usr/bin/env python
"""Floats a pallet on air cushions to a dock: blows up the cushions, pushes it with fans, and sets it down."""

import math

import rospy
from geometry_msgs.msg import PoseStamped, Wrench
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, String

GROUNDED = "grounded"
INFLATING = "inflating"
MOVING = "moving"
LOWERING = "lowering"
DOCKED = "docked"


class AirPallet(object):
    def __init__(self):
        self.rate = rospy.get_param("~rate", 10.0)
        self.kp = rospy.get_param("~kp", 0.45)  # N per m and kg
        self.max_push = rospy.get_param("~max_push", 0.5)  # N per kg, of each fan
        self.mass = rospy.get_param("~mass", 240.0)
        self.inflate_time = rospy.get_param("~inflate_time", 1.5)
        self.lower_time = rospy.get_param("~lower_time", 1.0)
        self.dock_radius = rospy.get_param("~dock_radius", 0.06)
        self.dock_ticks = rospy.get_param("~dock_ticks", 6)
        self.state = GROUNDED
        self.since = rospy.Time(0)
        self.pose = None
        self.goal = None
        self.inside = 0
        self.fan_pub = rospy.Publisher("fans/wrench", Wrench, queue_size=1)
        self.air_pub = rospy.Publisher("cushions/air", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("pallet/state", String, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.odom_cb)
        rospy.Subscriber("dock", PoseStamped, self.dock_cb)
        rospy.Timer(rospy.Duration(1.0 / self.rate), self.tick)

    def odom_cb(self, msg):
        self.pose = msg.pose.pose.position

    def dock_cb(self, msg):
        if self.goal is None:
            rospy.loginfo("dock at %.2f, %.2f", msg.pose.position.x, msg.pose.position.y)
        self.goal = msg.pose.position

    def go(self, state):
        rospy.logdebug("%s -> %s", self.state, state)
        self.state = state
        self.since = rospy.Time.now()

    def push(self, error):
        """Push along one axis, in N per kg."""
        return max(-self.max_push, min(self.max_push, self.kp * error))

    def tick(self, event):
        if self.pose is None or self.goal is None:
            return
        elapsed = (rospy.Time.now() - self.since).to_sec()
        ex = self.goal.x - self.pose.x
        ey = self.goal.y - self.pose.y
        wrench = Wrench()
        air = True
        if self.state == GROUNDED:
            self.go(INFLATING)
        elif self.state == INFLATING:
            if elapsed > self.inflate_time:
                self.go(MOVING)
        elif self.state == MOVING:
            wrench.force.x = self.mass * self.push(ex)
            wrench.force.y = self.mass * self.push(ey)
            self.inside = self.inside + 1 if math.hypot(ex, ey) < self.dock_radius else 0
            if self.inside >= self.dock_ticks:
                self.go(LOWERING)
        elif self.state == LOWERING:
            air = False
            if elapsed > self.lower_time:
                self.go(DOCKED)
        else:
            air = False
        self.fan_pub.publish(wrench)
        self.air_pub.publish(air)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("air_pallet")
    AirPallet()
    rospy.spin()
