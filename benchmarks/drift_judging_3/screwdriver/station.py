#!/usr/bin/env python3
"""Tighten the screws of a flange one after the other: run down, tighten to the torque, stop."""

import rospy
from std_msgs.msg import Bool, Float64, Int32, String


class Spindle:
    """Torque control of one screw."""

    def __init__(self, settings):
        self.settings = settings
        self.stage = "rundown"
        self.turns = 0.0

    def speed(self):
        """Return the RPM of this stage."""
        if self.stage == "rundown":
            return self.settings["rundown_rpm"]
        if self.stage == "final":
            return self.settings["final_rpm"]
        return 0.0

    def update(self, torque, turns):
        """Update the stage from the torque of the transducer; return the new stage."""
        self.turns = turns
        if turns > self.settings["strip_angle"]:
            self.stage = "stripped"
        elif self.stage == "rundown" and torque > self.settings["snug_torque"]:
            self.stage = "final"
        elif self.stage == "final" and torque >= self.settings["torque"]:
            self.stage = "tight"
        return self.stage


class Station:
    """Tighten one screw after the other."""

    def __init__(self):
        self.settings = rospy.get_param("~tightening")
        self.screws = 0
        self.current = 0
        self.torque = 0.0
        self.turns = 0.0
        self.lift_until = None
        self.spindle = Spindle(self.settings)
        self.rpm_pub = rospy.Publisher("spindle/rpm", Float64, queue_size=1)
        self.screw_pub = rospy.Publisher("spindle/screw", Int32, queue_size=1)
        self.result_pub = rospy.Publisher("station/result", String, queue_size=10)
        self.done_pub = rospy.Publisher("station/done", Bool, queue_size=1)
        rospy.Subscriber("station/screws", Int32, self.screws_cb)
        rospy.Subscriber("spindle/turns", Float64, self.turns_cb)
        rospy.Subscriber("spindle/torque", Float64, self.torque_cb)
        rospy.Timer(rospy.Duration(0.05), self.timer_cb)

    def screws_cb(self, msg):
        """Store the number of screws in this part."""
        self.screws = msg.data

    def turns_cb(self, msg):
        """Store the angle from the encoder of the spindle."""
        self.turns = msg.data

    def torque_cb(self, msg):
        """Store the torque of the transducer, with the ripple of the gear filtered out."""
        self.torque = 0.2 * self.torque + 0.8 * msg.data

    def timer_cb(self, _event):
        """Control the spindle."""
        if self.current >= self.screws:
            self.rpm_pub.publish(0.0)
            self.done_pub.publish(self.screws > 0)
            return
        now = rospy.get_time()
        self.screw_pub.publish(self.current)
        if self.lift_until is not None:
            self.rpm_pub.publish(0.0)
            if now >= self.lift_until:
                self.lift_until = None
                self.current += 1
                self.torque = 0.0
                self.spindle = Spindle(self.settings)
            return
        stage = self.spindle.update(self.torque, self.turns)
        self.rpm_pub.publish(self.spindle.speed())
        if stage in ("tight", "stripped"):
            self.result_pub.publish("%d %s" % (self.current, stage))
            self.lift_until = now + self.settings["lift_seconds"]


if __name__ == "__main__":
    rospy.init_node("station")
    Station()
    rospy.spin()
