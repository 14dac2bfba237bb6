#!/usr/bin/env python
"""Opens a bottle of wine: centres the bell on the neck, drives the screw into the cork, and pulls the cork out."""

import math

import rospy
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String


class CorkPuller(object):
    def __init__(self):
        self.pitch = rospy.get_param("~pitch", 0.008)  # m per turn of the screw
        self.drive_depth = rospy.get_param("~drive_depth", 0.033)  # m of screw in the cork
        self.screw_speed = rospy.get_param("~screw_speed", 1.5)  # turns per second
        self.press_force = rospy.get_param("~press_force", 25.0)  # N
        self.pull_speed = rospy.get_param("~pull_speed", 0.02)  # m/s
        self.ease_speed = rospy.get_param("~ease_speed", 0.006)  # m/s, while the cork sticks
        self.stick_force = rospy.get_param("~stick_force", 140.0)
        self.free_force = rospy.get_param("~free_force", 15.0)
        self.max_force = rospy.get_param("~max_force", 420.0)
        self.max_pull = rospy.get_param("~max_pull", 0.075)  # m, travel of the lift
        self.state = "wait"
        self.turned = 0.0  # turns
        self.touched_at = None
        self.lift = 0.0
        self.lift_from = 0.0
        self.force = 0.0
        self.bottle = False
        self.pubs = {
            "screw": rospy.Publisher("screw/speed", Float64, queue_size=1),
            "lift": rospy.Publisher("lift/speed", Float64, queue_size=1),
            "press": rospy.Publisher("bell/press", Float64, queue_size=1),
            "state": rospy.Publisher("opener/state", String, queue_size=1),
        }
        rospy.Subscriber("joint_states", JointState, self.on_joints)
        rospy.Subscriber("lift/force", WrenchStamped, self.on_force)
        rospy.Subscriber("bottle/clamped", Bool, self.on_bottle)
        rospy.Timer(rospy.Duration(0.05), self.cycle)

    def on_joints(self, msg):
        joints = dict(zip(msg.name, msg.position))
        self.turned = joints["screw"] / (2.0 * math.pi)
        self.lift = joints["lift"]

    def on_force(self, msg):
        self.force += 0.5 * (msg.wrench.force.z - self.force)

    def on_bottle(self, msg):
        self.bottle = msg.data

    def become(self, state):
        rospy.loginfo("%s -> %s, %.0f N", self.state, state, self.force)
        self.state = state

    def depth(self):
        """Length of the screw that is in the cork."""
        return self.pitch * (self.turned - self.touched_at)

    def drive(self):
        if self.touched_at is None:
            if self.force < -0.5 * self.press_force:  # the tip stands on the cork
                self.touched_at = self.turned
        elif self.depth() >= self.drive_depth:
            self.lift_from = self.lift
            self.become("pull")
            return 0.0
        return self.screw_speed

    def pull(self):
        if self.force > self.max_force:
            rospy.logerr("cork does not move")
            self.become("stuck")
            return 0.0
        pulled = self.lift - self.lift_from
        if pulled > 0.02 and self.force < self.free_force:
            self.become("open")
            return 0.0
        if pulled > self.max_pull:
            self.become("stuck")
            return 0.0
        return self.ease_speed if self.force > self.stick_force else self.pull_speed

    def cycle(self, event):
        screw, lift, press = 0.0, 0.0, 0.0
        if self.state == "wait":
            if self.bottle:
                self.become("drive")
        elif self.state == "drive":
            press = self.press_force
            screw = self.drive()
        elif self.state == "pull":
            lift = self.pull()
        self.pubs["screw"].publish(screw)
        self.pubs["lift"].publish(lift)
        self.pubs["press"].publish(press)
        self.pubs["state"].publish(self.state)


if __name__ == "__main__":
    rospy.init_node("cork_puller")
    CorkPuller()
    rospy.spin()
