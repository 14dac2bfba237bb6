#!/usr/bin/env python
"""Tracked stair climber: drives to a flight of stairs, mounts it on its flippers, climbs, and eases over the top."""

import math

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Imu, Range
from std_msgs.msg import Float32, String

APPROACH, MOUNT, CLIMB, CREST, LANDED, ABORT = "approach", "mount", "climb", "crest", "landed", "abort"


def pitch_of(q):
    return math.asin(max(-1.0, min(1.0, 2.0 * (q.w * q.y - q.z * q.x))))


class StairClimber(object):
    def __init__(self):
        ns = "~climb/"
        self.approach_effort = rospy.get_param(ns + "approach_effort", 0.25)
        self.climb_effort = rospy.get_param(ns + "climb_effort", 0.5)
        self.crest_effort = rospy.get_param(ns + "crest_effort", 0.3)
        self.flipper_up = rospy.get_param(ns + "flipper_up", 0.5)  # rad, to mount
        self.flipper_flat = rospy.get_param(ns + "flipper_flat", 0.0)
        self.flipper_down = rospy.get_param(ns + "flipper_down", -0.5)  # rad, to soften the top
        self.mount_range = rospy.get_param(ns + "mount_range", 0.35)  # m to the first riser
        self.climb_pitch = rospy.get_param(ns + "climb_pitch", 0.38)  # rad
        self.level_pitch = rospy.get_param(ns + "level_pitch", 0.12)
        self.tip_pitch = rospy.get_param(ns + "tip_pitch", 1.0)
        self.edge_range = rospy.get_param(ns + "edge_range", 0.5)  # m, no more step in front
        self.mount_timeout = rospy.get_param(ns + "mount_timeout", 8.0)
        self.state = APPROACH
        self.since = None
        self.pitch = 0.0
        self.front = None
        self.drive_pub = rospy.Publisher("tracks/effort", Twist, queue_size=1)
        self.flipper_pub = rospy.Publisher("flippers/angle", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("climber/state", String, queue_size=1)
        rospy.Subscriber("imu", Imu, self.imu_cb)
        rospy.Subscriber("front/range", Range, self.range_cb)

    def imu_cb(self, msg):
        self.pitch = 0.6 * self.pitch + 0.4 * pitch_of(msg.orientation)

    def range_cb(self, msg):
        self.front = msg.range

    def change(self, state):
        rospy.loginfo("%s at %.2f rad", state, self.pitch)
        self.state = state
        self.since = rospy.get_time()

    def plan(self):
        """Return the effort of the tracks and the angle of the flippers, both for this state."""
        if self.state == APPROACH:
            if self.front < self.mount_range:
                self.change(MOUNT)
            return self.approach_effort, self.flipper_up
        if self.state == MOUNT:
            if self.pitch > self.climb_pitch:
                self.change(CLIMB)
            elif rospy.get_time() - self.since > self.mount_timeout:
                rospy.logwarn("cannot mount the first step")
                self.change(ABORT)
            return self.climb_effort, self.flipper_up
        if self.state == CLIMB:
            if self.front > self.edge_range:
                self.change(CREST)
            return self.climb_effort, self.flipper_flat
        if self.state == CREST:
            if abs(self.pitch) < self.level_pitch:
                self.change(LANDED)
            return self.crest_effort, self.flipper_down
        return 0.0, self.flipper_flat

    def run(self):
        rate = rospy.Rate(10)
        while not rospy.is_shutdown():
            if self.front is not None:
                if self.pitch > self.tip_pitch and self.state != ABORT:
                    rospy.logerr("about to tip over")
                    self.change(ABORT)
                effort, flippers = self.plan()
                cmd = Twist()
                cmd.linear.x = effort
                self.drive_pub.publish(cmd)
                self.flipper_pub.publish(flippers)
                self.state_pub.publish(self.state)
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("stair_climber")
    StairClimber().run()
