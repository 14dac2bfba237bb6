#!/usr/bin/env python
"""Belay winch of a climbing gym: takes in rope, catches falls and lowers climbers."""

import enum

import rospy
from std_msgs.msg import Bool, Float64, String


class Mode(enum.Enum):
    GROUND = 0
    CLIMB = 1
    LOCKED = 2
    LOWER = 3


class BelayWinch(object):
    TAKE_IN = 0.9  # maximum speed (m/s)
    LOWERING = 0.7

    def __init__(self, fall_speed=1.1, slack_tension=25.0):
        self.fall_speed = fall_speed
        self.slack_tension = slack_tension
        self.k_tension = rospy.get_param("~k_tension", 0.03)
        self.hang_time = rospy.get_param("~hang_time", 0.8)
        self.soft_start = rospy.get_param("~soft_start", 1.5)
        self.ground = rospy.get_param("~ground_height", 0.35)
        self.mode = Mode.GROUND
        self.entered = rospy.Time.now()
        self.height = 0.0
        self.tension = 0.0
        self.out = 0.0
        self.brake = rospy.Publisher("winch/brake", Bool, queue_size=1)
        self.speed = rospy.Publisher("winch/speed", Float64, queue_size=1)
        self.light = rospy.Publisher("winch/light", String, queue_size=1)
        rospy.Subscriber("rope/out_speed", Float64, self.rope_cb)
        rospy.Subscriber("rope/tension", Float64, self.tension_cb)
        rospy.Subscriber("climber/height", Float64, self.height_cb)
        rospy.Subscriber("winch/oil_temperature", Float64, self.oil_cb)

    def rope_cb(self, msg):
        self.out = 0.6 * msg.data + 0.4 * self.out

    def tension_cb(self, msg):
        self.tension = msg.data

    def height_cb(self, msg):
        self.height = msg.data

    def oil_cb(self, msg):
        if msg.data > 70.0:
            rospy.logwarn_throttle(60, "oil of the brake at %d degrees", msg.data)

    def enter(self, mode):
        self.mode = mode
        self.entered = rospy.Time.now()

    def since(self):
        return (rospy.Time.now() - self.entered).to_sec()

    def spin_once(self):
        speed = 0.0
        if self.mode is Mode.GROUND:
            speed = self.take_in()
            if self.height > 1.4:
                self.enter(Mode.CLIMB)
        elif self.mode is Mode.CLIMB:
            speed = self.take_in()
            if self.out > self.fall_speed:
                self.enter(Mode.LOCKED)
            elif self.height < self.ground:
                self.enter(Mode.GROUND)
        elif self.mode is Mode.LOCKED:
            if self.since() > self.hang_time:
                self.enter(Mode.LOWER)
        elif self.mode is Mode.LOWER:
            speed = -self.LOWERING * min(1.0, 0.2 + self.since() / self.soft_start)
            if self.height < self.ground:
                self.enter(Mode.GROUND)
        self.brake.publish(self.mode is Mode.LOCKED)
        self.speed.publish(speed)
        self.light.publish("red" if self.mode in (Mode.LOCKED, Mode.LOWER) else "green")

    def take_in(self):
        wish = self.k_tension * (self.slack_tension - self.tension)
        return max(-self.TAKE_IN, min(self.TAKE_IN, wish))


if __name__ == "__main__":
    rospy.init_node("belay_winch")
    winch = BelayWinch()
    loop = rospy.Rate(20)
    while not rospy.is_shutdown():
        winch.spin_once()
        loop.sleep()
