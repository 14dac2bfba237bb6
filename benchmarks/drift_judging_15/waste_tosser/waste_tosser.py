#!/usr/bin/env python
"""Picks items from a sorting belt and tosses them into a bin."""

import math

import rospy
from ballistics import launch_speed
from geometry_msgs.msg import PointStamped, WrenchStamped
from std_msgs.msg import Float32, String

ARM = {
    "reach": 0.85,  # m
    "max_speed": 7.5,  # speed of the gripper (m/s)
    "release_angle": 0.70,  # angle above the horizon (rad)
    "lead": 0.04,  # time that the gripper needs to open (s)
}
SPEED_GAIN = 1.04  # tracking gain of the arm, measured with empty bottles
BIN_DEPTH = 0.30  # distance from the front edge to the middle (m)
GRIP_OK = 0.3  # N
HEAVY = 15.0  # N


class WasteTosser(object):
    def __init__(self):
        self.bin_filter = rospy.get_param("~bin_filter", 0.4)
        self.settle_time = rospy.get_param("~settle_time", 0.4)
        self.min_throw = rospy.get_param("~min_throw", 0.6)
        self.max_throw = rospy.get_param("~max_throw", 2.6)
        self.release_height = rospy.get_param("~release_height", 0.9)
        self.bin_range = None
        self.weight = 0.0
        self.holding_since = None
        self.tossed = 0
        self.throw_pub = rospy.Publisher("arm/throw", PointStamped, queue_size=1)
        self.status_pub = rospy.Publisher("tosser/status", String, queue_size=1)
        rospy.Subscriber("bin/range", Float32, self.bin_cb, queue_size=1)
        rospy.Subscriber("gripper/wrench", WrenchStamped, self.wrench_cb, queue_size=1)
        self.timer = rospy.Timer(rospy.Duration(0.1), self.update)

    def bin_cb(self, msg):
        if self.bin_range is None:
            self.bin_range = msg.data
        self.bin_range += self.bin_filter * (msg.data - self.bin_range)

    def wrench_cb(self, msg):
        self.weight = -msg.wrench.force.z
        if self.weight < GRIP_OK:
            self.holding_since = None
        elif self.holding_since is None:
            self.holding_since = rospy.Time.now()
        if self.weight > HEAVY:
            rospy.logerr_throttle(5.0, "item too heavy: %.1f N" % self.weight)

    def settled(self):
        if self.holding_since is None:
            return False
        return (rospy.Time.now() - self.holding_since).to_sec() > self.settle_time

    def throw(self, distance):
        speed = SPEED_GAIN * launch_speed(distance, self.release_height, ARM["release_angle"])
        msg = PointStamped()
        msg.header.stamp = rospy.Time.now()
        msg.point.x = min(speed, ARM["max_speed"])
        msg.point.y = ARM["release_angle"]
        msg.point.z = ARM["lead"]
        self.throw_pub.publish(msg)
        self.tossed += 1
        self.holding_since = None

    def update(self, _event):
        if self.bin_range is None or not self.settled():
            return
        distance = self.bin_range + BIN_DEPTH - ARM["reach"] * math.cos(ARM["release_angle"])
        if not self.min_throw < distance < self.max_throw:
            self.status_pub.publish("bin out of reach")
            return
        self.throw(distance)


if __name__ == "__main__":
    rospy.init_node("waste_tosser")
    WasteTosser()
    rospy.spin()
