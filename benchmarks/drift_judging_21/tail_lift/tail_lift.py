#!/usr/bin/env python
"""Tail lift of a parcel van: raises its platform on request to the floor of the van, and locks it there."""

import rospy
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32, String

IDLE, FAST, SLOW, SETTLE, LOCKED, FAULT = range(6)
NAMES = ["idle", "fast", "slow", "settle", "locked", "fault"]


class TailLift:
    def __init__(self):
        self.valve_pub = rospy.Publisher("hydraulics/valve", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("lift/state", String, queue_size=1)
        p = rospy.get_param("~", {})
        self.floor = p.get("floor_height", 1.05)  # m
        self.fast_opening = p.get("fast_opening", 0.8)
        self.slow_opening = p.get("slow_opening", 0.28)
        self.slow_zone = p.get("slow_zone", 0.1)  # m below the floor
        self.lead = p.get("stop_lead", 0.007)  # m, what the platform still does with the valve shut
        self.stall_time = p.get("stall_time", 8.0)
        self.state = IDLE
        self.entered = rospy.Time.now()
        self.height = None
        rospy.Subscriber("platform/height", Range, self.height_cb)
        rospy.Subscriber("lift/request", Bool, self.request_cb)
        rospy.Timer(rospy.Duration(0.1), self.spin_once)

    def height_cb(self, msg):
        self.height = msg.range

    def request_cb(self, msg):
        if msg.data and self.state == IDLE:
            self.enter(FAST)

    def enter(self, state):
        rospy.loginfo("%s -> %s", NAMES[self.state], NAMES[state])
        self.state = state
        self.entered = rospy.Time.now()

    def in_state(self):
        return (rospy.Time.now() - self.entered).to_sec()

    def opening(self):
        if self.state == FAST:
            return self.fast_opening
        if self.state == SLOW:
            return self.slow_opening
        return 0.0

    def spin_once(self, event):
        if self.height is None:
            return
        left = self.floor - self.height
        if self.state == FAST and left < self.slow_zone:
            self.enter(SLOW)
        elif self.state == SLOW:
            if left < self.lead:
                self.enter(SETTLE)
            elif self.in_state() > self.stall_time:
                rospy.logerr("platform is stuck %.2f m below the floor", left)
                self.enter(FAULT)
        elif self.state == SETTLE and self.in_state() > 0.7:
            self.enter(LOCKED)
        self.valve_pub.publish(self.opening())
        self.state_pub.publish(NAMES[self.state])


if __name__ == "__main__":
    rospy.init_node("tail_lift")
    TailLift()
    rospy.spin()
