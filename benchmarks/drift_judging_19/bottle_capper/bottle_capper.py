#!/usr/bin/env python
"""Screws caps on bottles: lowers the chuck, runs the cap on, and tightens it to a torque."""

import rospy
from std_msgs.msg import Bool, Float32, String

WAIT = "wait"
LOWER = "lower"
RUN_ON = "run_on"
TIGHTEN = "tighten"
RAISE = "raise"

PERIOD = 0.02


class BottleCapper(object):
    def __init__(self):
        self.run_rpm = rospy.get_param("~run_rpm", 180.0)
        self.tight_rpm = rospy.get_param("~tight_rpm", 30.0)
        self.contact_torque = rospy.get_param("~contact_torque", 0.35)  # Nm, the cap has met the bottle
        self.target_torque = rospy.get_param("~target_torque", 1.35)
        self.max_turns = rospy.get_param("~max_turns", 2.0)  # more: the thread is stripped
        self.spin_timeout = rospy.get_param("~spin_timeout", 1.15)  # s
        self.head_force = rospy.get_param("~head_force", 40.0)  # N
        self.touch_force = rospy.get_param("~touch_force", 12.0)
        self.lower_timeout = rospy.get_param("~lower_timeout", 0.8)
        self.raise_time = rospy.get_param("~raise_time", 0.2)
        self.torque_share = rospy.get_param("~torque_share", 0.7)
        self.state = WAIT
        self.since = 0.0
        self.present = False
        self.torque = 0.0
        self.force = 0.0
        self.turns = 0.0
        self.verdict = ""
        self.rpm_pub = rospy.Publisher("spindle/rpm", Float32, queue_size=1)
        self.head_pub = rospy.Publisher("head/force", Float32, queue_size=1)
        self.verdict_pub = rospy.Publisher("capper/verdict", String, queue_size=1)
        self.state_pub = rospy.Publisher("capper/state", String, queue_size=1)
        rospy.Subscriber("bottle/present", Bool, self.present_cb)
        rospy.Subscriber("spindle/torque", Float32, self.torque_cb)
        rospy.Subscriber("spindle/turns", Float32, self.turns_cb)
        rospy.Subscriber("head/load", Float32, self.load_cb)
        rospy.Timer(rospy.Duration(PERIOD), self.tick)

    def present_cb(self, msg):
        self.present = msg.data

    def torque_cb(self, msg):
        self.torque += self.torque_share * (msg.data - self.torque)

    def turns_cb(self, msg):
        self.turns = msg.data

    def load_cb(self, msg):
        self.force = msg.data

    def enter(self, state):
        self.state = state
        self.since = rospy.get_time()

    def finish(self, verdict):
        if verdict != "good":
            rospy.logwarn("cap rejected (%s) at %.2f turns, %.2f Nm", verdict, self.turns, self.torque)
        self.verdict = verdict
        self.enter(RAISE)

    def spinning(self, elapsed):
        """Check the cap while it turns; return whether it may turn on."""
        if self.turns > self.max_turns:
            self.finish("stripped")
        elif elapsed > self.spin_timeout:
            self.finish("timeout")
        else:
            return True
        return False

    def tick(self, event):
        elapsed = rospy.get_time() - self.since
        rpm, force = 0.0, 0.0
        if self.state == WAIT:
            self.verdict = ""
            if self.present:
                self.enter(LOWER)
        elif self.state == LOWER:
            force = self.head_force
            if self.force > self.touch_force:
                self.enter(RUN_ON)
            elif elapsed > self.lower_timeout:
                self.finish("no cap")
        elif self.state == RUN_ON:
            force = self.head_force
            if self.spinning(elapsed):
                rpm = self.run_rpm
                if self.torque > self.contact_torque:
                    rpm = self.tight_rpm
                    self.state = TIGHTEN  # the time goes on
        elif self.state == TIGHTEN:
            force = self.head_force
            if self.torque > self.target_torque:
                self.finish("good")
            elif self.spinning(elapsed):
                rpm = self.tight_rpm
        elif self.state == RAISE:
            if elapsed > self.raise_time and not self.present:
                self.enter(WAIT)
        self.rpm_pub.publish(rpm)
        self.head_pub.publish(force)
        self.verdict_pub.publish(self.verdict)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("bottle_capper")
    BottleCapper()
    rospy.spin()
