#!/usr/bin/env python3
"""Docks a passenger bridge: levels its floor with the cabin door, extends, and says when it is docked."""

from enum import Enum

import rospy
from std_msgs.msg import Bool, Float32


class Mode(Enum):
    IDLE = 0
    LEVEL = 1
    EXTEND = 2
    DOCKED = 3


class Bridge:
    GAIN = 0.8  # 1/s
    LIFT = 0.12  # largest speed (m/s)
    FLUSH = 0.03  # largest step that counts as level (m)
    CREEP = 1.2  # distance from the aircraft (m)
    CONTACT = 0.06

    def __init__(self):
        self.mode = Mode.IDLE
        self.step = None
        self.gap = None
        self.lift = rospy.Publisher("bridge/lift", Float32, queue_size=1)
        self.tunnel = rospy.Publisher("bridge/tunnel", Float32, queue_size=1)
        self.docked = rospy.Publisher("bridge/docked", Bool, queue_size=1, latch=True)
        rospy.Subscriber("bridge/step", Float32, lambda m: setattr(self, "step", m.data))
        rospy.Subscriber("bridge/gap", Float32, lambda m: setattr(self, "gap", m.data))

    def level(self):
        speed = max(-self.LIFT, min(self.LIFT, self.GAIN * self.step))
        self.lift.publish(speed)

    def extend(self):
        self.tunnel.publish(0.5 if self.gap > self.CREEP else 0.12)

    def spin_once(self):
        if self.mode is Mode.IDLE:
            if self.step is not None and self.gap is not None:
                self.mode = Mode.LEVEL
        elif self.mode is Mode.LEVEL:
            self.level()
            if abs(self.step) < self.FLUSH:
                self.mode = Mode.EXTEND
        elif self.mode is Mode.EXTEND:
            self.level()
            self.extend()
            if self.gap < self.CONTACT:
                self.lift.publish(0.0)
                self.tunnel.publish(0.0)
                self.docked.publish(True)
                self.mode = Mode.DOCKED


def main():
    rospy.init_node("bridge")
    bridge = Bridge()
    rate = rospy.Rate(5)
    while not rospy.is_shutdown():
        bridge.spin_once()
        rate.sleep()


if __name__ == "__main__":
    main()
