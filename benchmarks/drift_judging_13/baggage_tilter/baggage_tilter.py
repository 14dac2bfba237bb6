#!/usr/bin/env python
"""Controller of one car of a tilt-tray sorter: tip each bag into the chute of its flight."""

import math

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

CHUTES = {1: 3.4, 2: 6.4}  # distances from the induction to the edge of each chute (m)
SPEED = 1.5  # speed of the chain (m/s)
TILT = math.radians(32)
LEVEL = 0.0
HOLD = 1.0  # time for which the tray stays tilted (s)
LEAD = 0.20  # time before the edge of the chute (s)
JAM_TIME = 20.0  # s without motion


class Car:
    IDLE = "idle"
    CARRY = "carry"
    TIP = "tip"
    CHECK = "check"

    def __init__(self):
        self.state = Car.IDLE
        self.position = 0.0
        self.moved = rospy.get_time()
        self.chute = 0
        self.occupied = False
        self.tipped_at = 0.0
        self.delivered = 0
        self.lost = 0

        self.tilt = rospy.Publisher("car/tilt", Float32, queue_size=1)
        self.event = rospy.Publisher("car/event", String, queue_size=5)
        self.belt_stop = rospy.Publisher("sorter/stop", Bool, queue_size=1)
        rospy.Subscriber("car/position", Float32, self.on_position)
        rospy.Subscriber("car/chute", Int32, self.on_chute)
        rospy.Subscriber("car/occupied", Bool, self.on_occupied)
        self.timer = rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_position(self, msg):
        if abs(msg.data - self.position) > 0.01:
            self.moved = rospy.get_time()
        self.position = msg.data

    def on_chute(self, msg):
        self.chute = msg.data

    def on_occupied(self, msg):
        self.occupied = msg.data

    def edge(self):
        """Position at which the tray has to begin to tilt."""
        return CHUTES[self.chute] - LEAD * SPEED

    def change(self, state):
        rospy.logdebug("%s -> %s", self.state, state)
        self.state = state

    def tick(self, _):
        now = rospy.get_time()
        if now - self.moved > JAM_TIME:
            self.belt_stop.publish(True)
            return

        if self.state == Car.IDLE:
            self.tilt.publish(LEVEL)
            if self.occupied and self.chute in CHUTES and self.position < self.edge():
                self.change(Car.CARRY)
        elif self.state == Car.CARRY:
            if self.position >= self.edge():
                self.tilt.publish(TILT)
                self.tipped_at = now
                self.change(Car.TIP)
        elif self.state == Car.TIP:
            if now - self.tipped_at >= HOLD:
                self.tilt.publish(LEVEL)
                self.change(Car.CHECK)
        elif self.state == Car.CHECK:
            if now - self.tipped_at >= HOLD + 0.6:
                self.finish()

    def finish(self):
        if self.occupied:
            self.lost += 1
            self.event.publish("recirculates")
            rospy.logwarn("bag for chute %d is still on the tray", self.chute)
        else:
            self.delivered += 1
            self.event.publish("delivered")
        self.change(Car.IDLE)


if __name__ == "__main__":
    rospy.init_node("baggage_tilter")
    car = Car()
    rospy.spin()
