#!/usr/bin/env python
"""Watches the lidar in front of the robot. Says how fast it may drive and still stop in time."""

import math

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, String

FRONT = 0.34  # m from the lidar to the bumper
HALF_WIDTH = 0.36
MARGIN = 0.22
DECEL = 0.7  # m/s2
DELAY = 0.25  # s
MIN_VALID = 0.05
FASTEST = 1.2


class FrontGuard(object):
    def __init__(self):
        self.hold = rospy.get_param("~hold", 3)  # scans for which a free path must last
        self.warn_below = rospy.get_param("~warn_below", 0.15)
        self.limit = 0.0
        self.free_scans = 0
        self.limit_pub = rospy.Publisher("guard/limit", Float32, queue_size=1)
        self.gap_pub = rospy.Publisher("guard/gap", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("guard/state", String, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.scan_cb)

    def nearest(self, scan):
        """Return how far ahead the nearest thing is that lies in the path of the robot."""
        best = scan.range_max
        for i, r in enumerate(scan.ranges):
            if not MIN_VALID < r < scan.range_max:
                continue
            angle = scan.angle_min + i * scan.angle_increment
            if abs(r * math.sin(angle)) < HALF_WIDTH:
                best = min(best, r * math.cos(angle))
        return best

    def allowed(self, gap):
        """Speed from which the robot still stops in the gap: v * delay + v^2 / 2a = gap."""
        if gap <= 0.0:
            return 0.0
        reach = DECEL * DELAY
        return min(FASTEST, math.sqrt(reach * reach + 2.0 * DECEL * gap) - reach)

    def scan_cb(self, scan):
        gap = self.nearest(scan) - FRONT - MARGIN
        now = self.allowed(gap)
        if now < self.limit:
            self.limit = now
            self.free_scans = 0
        else:
            self.free_scans += 1
            if self.free_scans >= self.hold:
                self.limit = now
        if gap < self.warn_below - MARGIN:
            rospy.logwarn_throttle(2.0, "something is %.2f m in front of the bumper", gap + MARGIN)
        self.limit_pub.publish(self.limit)
        self.gap_pub.publish(gap)
        self.state_pub.publish("stop" if self.limit < 0.02 else "go")


if __name__ == "__main__":
    rospy.init_node("front_guard")
    FrontGuard()
    rospy.spin()
