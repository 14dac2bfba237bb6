#!/usr/bin/env python
"""Throw a curling stone: push it along the ramp and let go at the speed with which it stops where the skip calls."""

import math

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float32, String

GRAVITY = 9.81
CALLS = {"guard": -3.0, "draw": 0.0, "back": 1.2}  # distance behind the middle of the house (m)


class Thrower(object):
    IDLE, PUSH, FOLLOW, PARKED = range(4)

    def __init__(self):
        self.friction = rospy.get_param("~friction", 0.0120)
        self.ramp_acceleration = rospy.get_param("~ramp_acceleration", 0.8)
        self.ramp_length = rospy.get_param("~ramp_length", 6.5)
        self.brake = rospy.get_param("~brake", 3.0)
        self.state = self.IDLE
        self.speed = 0.0
        self.command = 0.0
        self.place = 0.0
        self.to_house = None
        self.call = None
        self.drive = rospy.Publisher("carriage/cmd", Twist, queue_size=1)
        self.gripper = rospy.Publisher("gripper/open", Bool, queue_size=1)
        self.estimate = rospy.Publisher("scoreboard/seconds", Float32, queue_size=1)
        rospy.Subscriber("carriage/speed", Float32, self.on_speed)
        rospy.Subscriber("carriage/place", Float32, self.on_place)
        rospy.Subscriber("house/distance", Float32, self.on_distance)
        rospy.Subscriber("skip/call", String, self.on_call)
        rospy.Timer(rospy.Duration(0.05), self.step)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_place(self, msg):
        self.place = msg.data

    def on_distance(self, msg):
        """Store the distance from the end of the ramp to the middle of the house, measured by laser, m."""
        self.to_house = msg.data

    def on_call(self, msg):
        if msg.data in CALLS:
            self.call = msg.data

    def slide(self):
        """Return how far the stone has to slide after it is let go."""
        return self.to_house + CALLS[self.call] + self.ramp_length - self.place

    def release_speed(self):
        return math.sqrt(2.0 * self.friction * GRAVITY * self.slide())

    def step(self, _event):
        if self.state == self.IDLE:
            if self.to_house is not None and self.call is not None:
                self.state = self.PUSH
        elif self.state == self.PUSH:
            self.push()
        elif self.state == self.FOLLOW:
            self.command = max(0.0, self.command - self.brake * 0.05)
            if self.command == 0.0:
                self.state = self.PARKED
        self.send()

    def push(self):
        wanted = self.release_speed()
        self.command = min(wanted, self.command + self.ramp_acceleration * 0.05)
        if self.place > 0.95 * self.ramp_length:
            rospy.logwarn_throttle(5.0, "the ramp is too short")
        if self.command >= wanted and abs(self.speed - wanted) < 0.02:
            self.estimate.publish(2.0 * self.slide() / max(0.1, self.speed))
            self.gripper.publish(True)
            self.state = self.FOLLOW

    def send(self):
        cmd = Twist()
        cmd.linear.x = self.command
        self.drive.publish(cmd)


if __name__ == "__main__":
    rospy.init_node("curling_thrower")
    Thrower()
    rospy.spin()
