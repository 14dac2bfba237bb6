#!/usr/bin/env python
# Crawler for vineyards: drives along a row, turns on the spot, crosses the headland, turns, drives back

import math

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32MultiArray

TICKS = 400.0  # per metre
GAUGE = 0.52  # distance between the tracks (m)
ROW = 2.2  # distance between two rows (m)
SPEED = 0.5
TURN = 0.6  # rad/s

PLAN = [("drive", 2.5), ("turn", math.pi / 2), ("drive", ROW), ("turn", math.pi / 2), ("drive", 2.5)]


class VineCrawler:
    def __init__(self):
        self.leg = 0
        self.start = None
        self.ticks = None
        self.pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("tracks", Float32MultiArray, self.tracks_cb)

    def tracks_cb(self, msg):
        self.ticks = msg.data
        if self.start is None:
            self.start = self.ticks

    def travelled(self):
        left = (self.ticks[0] - self.start[0]) / TICKS
        right = (self.ticks[1] - self.start[1]) / TICKS
        return left, right

    def update(self):
        cmd = Twist()
        if self.ticks is not None and self.leg < len(PLAN):
            kind, amount = PLAN[self.leg]
            left, right = self.travelled()
            if kind == "drive":
                remaining = amount - (left + right) / 2
                cmd.linear.x = min(SPEED, 0.05 + 1.2 * remaining)
                cmd.angular.z = 1.5 * (left - right)  # keep straight
            else:
                turned = (right - left) / GAUGE
                remaining = amount - turned
                cmd.angular.z = min(TURN, 0.05 + 1.5 * remaining)
            if remaining < 0.01:
                self.leg += 1
                self.start = self.ticks
                cmd = Twist()
        self.pub.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("vine_crawler")
    crawler = VineCrawler()
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        crawler.update()
        rate.sleep()
