#!/usr/bin/env python
"""Trues bicycle wheels: spins the wheel past a gauge, turns one nipple at the worst place, and spins it again."""

from functools import partial

import rospy
import spokes
from geometry_msgs.msg import Vector3
from std_msgs.msg import Bool, Float32, Float32MultiArray, Int32, String

IDLE, SPIN, TURN, PASS, REJECT = "idle", "spin", "turn", "pass", "reject"


class WheelTruer(object):
    def __init__(self):
        self.good_enough = rospy.get_param("~good_enough", 0.3)  # mm
        self.most_corrections = rospy.get_param("~most_corrections", 60)
        self.most_turns = rospy.get_param("~most_turns", 6.0)  # of one nipple, in all
        self.reports = {}
        self.state = IDLE
        self.since = rospy.get_time()
        self.corrections = 0
        self.turned = {}
        self.profile = None
        self.clamped = False

        self.spin_pub = rospy.Publisher("stand/spin", Bool, queue_size=1)
        self.nipple_pub = rospy.Publisher("stand/nipple", Vector3, queue_size=1)
        self.state_pub = rospy.Publisher("truer/state", String, queue_size=1)
        self.runout_pub = rospy.Publisher("truer/runout", Float32, queue_size=1)
        rospy.Subscriber("gauge/profile", Float32MultiArray, self.on_profile)
        rospy.Subscriber("stand/clamped", Bool, self.on_clamped)
        for what in ("weight", "hub"):
            kind = Float32 if what == "weight" else Int32
            rospy.Subscriber("wheel/" + what, kind, partial(self.on_report, what))
        rospy.Timer(rospy.Duration(0.5), self.tick)

    def on_report(self, what, msg):
        """Keep what the loader knows about the wheel, for the protocol."""
        if what not in self.reports:
            rospy.loginfo("wheel: %s %s", what, msg.data)
        self.reports[what] = msg.data

    def on_clamped(self, msg):
        if msg.data and not self.clamped:
            self.corrections = 0
            self.turned = {}
            self.enter(SPIN)
        elif self.clamped and not msg.data and self.state not in (PASS, REJECT):
            rospy.logerr("wheel came out of the clamp")
            self.enter(IDLE)
        self.clamped = msg.data

    def on_profile(self, msg):
        if self.state == SPIN:
            self.profile = list(msg.data)

    def enter(self, state):
        self.state = state
        self.since = rospy.get_time()
        self.profile = None

    def judge(self, profile):
        """Pass, reject, or correct the wheel once."""
        place = spokes.worst(profile)
        runout = abs(profile[place])
        self.runout_pub.publish(runout)
        if runout < self.good_enough:
            self.enter(PASS)
            return
        if self.corrections >= self.most_corrections:
            rospy.logwarn("%.2f mm after %d corrections", runout, self.corrections)
            self.enter(REJECT)
            return
        spoke = spokes.puller(profile, place)
        turns = spokes.turns_for(profile[place])
        used = self.turned.get(spoke, 0.0) + turns
        if used > self.most_turns:
            rospy.logwarn("nipple %d would have %.1f turns, protocol: %s", spoke, used, self.reports)
            self.enter(REJECT)
            return
        self.turned[spoke] = used
        self.corrections += 1
        self.nipple_pub.publish(Vector3(float(spoke), turns, 0.0))
        self.enter(TURN)

    def tick(self, event):
        if self.state == SPIN:
            if self.profile is not None:
                self.judge(self.profile)
            elif rospy.get_time() - self.since > 10.0:
                rospy.logerr("no profile from the gauge")
                self.enter(REJECT)
        elif self.state == TURN and rospy.get_time() - self.since >= 1.0:
            self.enter(SPIN)
        self.spin_pub.publish(self.state == SPIN)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("wheel_truer")
    WheelTruer()
    rospy.spin()
