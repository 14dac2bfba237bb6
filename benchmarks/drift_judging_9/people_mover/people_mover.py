#!/usr/bin/env python
"""Drive a people mover from platform to platform and stop with its doors at the platform's doors."""

import math

import rospy
from std_msgs.msg import Bool, Float32, String


class PeopleMover(object):
    def __init__(self):
        self.cruise = rospy.get_param("~cruise", 9.0)  # m/s
        self.accel = rospy.get_param("~accel", 1.0)  # acceleration at which passengers can stand (m/s^2)
        self.brake = rospy.get_param("~brake", 1.05)  # deceleration of the braking curve (m/s^2)
        self.creep = rospy.get_param("~creep", 0.25)  # speed in the last metre (m/s)
        self.creep_from = rospy.get_param("~creep_from", 0.8)  # m
        self.tolerance = rospy.get_param("~tolerance", 0.12)  # allowed offset of the doors (m)
        self.gain = rospy.get_param("~gain", 1.8)  # gain of the speed loop (1/s)
        self.max_brake = rospy.get_param("~max_brake", 2.0)  # m/s^2
        self.dwell = rospy.get_param("~dwell", 2.0)  # s
        self.distance = None
        self.speed = 0.0
        self.set_point = 0.0
        self.opened_at = None
        self.traction = rospy.Publisher("traction", Float32, queue_size=1)
        self.doors = rospy.Publisher("doors/open", Bool, queue_size=1)
        self.info = rospy.Publisher("~status", String, queue_size=1)
        rospy.Subscriber("platform/distance", Float32, self.distance_cb)
        rospy.Subscriber("wheel/speed", Float32, self.speed_cb)

    def distance_cb(self, msg):
        self.distance = msg.data

    def speed_cb(self, msg):
        self.speed = msg.data

    def curve(self, distance):
        """Return the speed from which the train still stops at the platform."""
        if distance < self.creep_from:
            return self.creep if distance > 0.0 else 0.0
        return math.sqrt(self.creep**2 + 2.0 * self.brake * (distance - self.creep_from))

    def stopped(self):
        return abs(self.speed) < 0.03 and abs(self.distance) < self.tolerance

    def step(self, dt):
        if self.distance is None:
            return
        now = rospy.get_time()
        if self.opened_at is not None:
            if now - self.opened_at > self.dwell and not self.stopped():
                self.opened_at = None
            self.traction.publish(-0.5)
            self.doors.publish(self.opened_at is not None)
            return
        if self.stopped():
            self.opened_at = now
            self.set_point = 0.0
            self.info.publish("boarding")
        allowed = min(self.cruise, self.curve(self.distance - 0.06))
        self.set_point = min(self.set_point + self.accel * dt, allowed)
        demand = self.gain * (self.set_point - self.speed)
        self.traction.publish(max(-self.max_brake, min(self.accel, demand)))
        self.doors.publish(False)


def main():
    rospy.init_node("people_mover")
    mover = PeopleMover()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        mover.step(0.1)
        rate.sleep()


if __name__ == "__main__":
    try:
        main()
    except rospy.ROSInterruptException:
        pass
