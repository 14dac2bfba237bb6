#!/usr/bin/env python
"""Vending machine: one turn of a spiral moves a bag over the edge, and a light curtain in the chute sees it fall.

Without a fall, the spiral is nudged on; if that does not help either, the customer gets the money back.
"""

from collections import namedtuple

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

Slot = namedtuple("Slot", "spirals pitch")  # spirals: number that turn together

SLOTS = {
    11: Slot(1, 45.0),
    12: Slot(1, 45.0),
    21: Slot(2, 60.0),
}

MOTOR_RPS = 0.5  # turns per s
FALL_TIME = 0.7  # s from the edge to the curtain
NUDGE = 0.16  # turns
NUDGES = 2
MAX_TURN = 1.3  # turns without a home switch: the motor is jammed
REST = 0.6  # s between two customers


class VendingSpiral(object):
    def __init__(self):
        self.slot = None
        self.phase = "ready"
        self.since = rospy.get_time()
        self.nudges = 0
        self.dropped = False
        self.home = True
        self.left_home = False
        self.motor_pub = rospy.Publisher("spiral/speed", Float32, queue_size=1)
        self.result_pub = rospy.Publisher("vend/result", String, queue_size=5)
        rospy.Subscriber("vend/order", Int32, self.on_order)
        rospy.Subscriber("spiral/home", Bool, self.on_home)
        rospy.Subscriber("chute/curtain", Bool, self.on_curtain)
        rospy.Timer(rospy.Duration(0.1), self.run)

    def on_order(self, msg):
        if self.phase != "ready":
            self.result_pub.publish("busy")
        elif msg.data not in SLOTS:
            self.result_pub.publish("unknown slot")
        else:
            self.slot = SLOTS[msg.data]
            self.nudges = 0
            self.dropped = False
            self.left_home = False
            self.enter("turn")

    def on_home(self, msg):
        self.home = msg.data
        if not msg.data:
            self.left_home = True

    def on_curtain(self, msg):
        # the curtain also sees hands in the chute, which only count while a bag may fall
        if msg.data and self.phase in ("turn", "nudge", "listen"):
            self.dropped = True

    def enter(self, phase):
        rospy.logdebug("%s -> %s", self.phase, phase)
        self.phase = phase
        self.since = rospy.get_time()

    def elapsed(self):
        return rospy.get_time() - self.since

    def finish(self, result):
        self.result_pub.publish(result)
        self.enter("rest")

    def run(self, event):
        speed = 0.0
        if self.phase == "turn":
            speed = MOTOR_RPS
            if self.elapsed() > MAX_TURN / MOTOR_RPS:
                self.finish("jammed")
            elif self.home and self.left_home:
                self.enter("listen")
        elif self.phase == "nudge":
            speed = MOTOR_RPS
            if self.elapsed() > NUDGE / MOTOR_RPS:
                self.enter("listen")
        elif self.phase == "listen":
            if self.dropped:
                self.finish("sold")
            elif self.elapsed() > FALL_TIME:
                if self.nudges < NUDGES:
                    self.nudges += 1
                    self.enter("nudge")
                else:
                    rospy.logwarn("bag hangs, refund")
                    self.finish("refund")
        elif self.phase == "rest" and self.elapsed() > REST:
            self.enter("ready")
        if self.phase not in ("turn", "nudge"):
            speed = 0.0
        self.motor_pub.publish(speed)


if __name__ == "__main__":
    rospy.init_node("vending_spiral")
    VendingSpiral()
    rospy.spin()
