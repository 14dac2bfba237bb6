#!/usr/bin/env python
"""Stacks packs of bricks: grips a pack, lifts it, travels to the pallet, lowers it and lets it go."""

from collections import namedtuple

import rospy
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import Float32, Int32, String

Move = namedtuple("Move", "axis goal")

GRIP_FORCE = 800.0  # N per jaw
LIFT_ACCEL = 4.0  # m/s2
TRAVEL_ACCEL = 1.2  # m/s2
TOP_SPEED = {"lift": 0.8, "travel": 1.2}  # m/s
ARRIVED = 0.015  # m
GRIP_TIMEOUT = 4.0  # s


class Ramp(object):
    """Gives the speed of one axis: up with the acceleration, down so that it stops at the goal."""

    def __init__(self, accel, top):
        self.accel = accel
        self.top = top
        self.speed = 0.0

    def next(self, rest, dt):
        direction = 1.0 if rest >= 0.0 else -1.0
        stop = (2.0 * 0.8 * self.accel * abs(rest)) ** 0.5
        wanted = direction * min(self.top, stop, 3.0 * abs(rest))
        step = self.accel * dt
        self.speed += max(-step, min(step, wanted - self.speed))
        return self.speed


class Gripper(object):
    def __init__(self):
        self.rate = rospy.get_param("~rate", 10.0)
        self.height = rospy.get_param("~safe_height", 1.1)
        self.pallet = rospy.get_param("~pallet", 2.4)
        self.layer = rospy.get_param("~layer_height", 0.24)
        self.axes = {
            "lift": Ramp(LIFT_ACCEL, TOP_SPEED["lift"]),
            "travel": Ramp(TRAVEL_ACCEL, TOP_SPEED["travel"]),
        }
        self.at = None
        self.jaws = 0.0
        self.packs = 0
        self.placed = 0
        self.step = "idle"
        self.since = rospy.get_time()
        self.plan = []
        self.speed_pub = rospy.Publisher("gantry/speed", Vector3, queue_size=1)
        self.force_pub = rospy.Publisher("jaws/force", Float32, queue_size=1)
        self.step_pub = rospy.Publisher("stacker/step", String, queue_size=1)
        self.placed_pub = rospy.Publisher("stacker/placed", Int32, queue_size=1)
        rospy.Subscriber("gantry/position", Point, self.position_cb)
        rospy.Subscriber("jaws/measured", Float32, self.jaws_cb)
        rospy.Subscriber("belt/packs", Int32, self.packs_cb)
        rospy.Timer(rospy.Duration(1.0 / self.rate), self.run)

    def position_cb(self, msg):
        self.at = {"travel": msg.x, "lift": msg.z}

    def jaws_cb(self, msg):
        self.jaws = msg.data

    def packs_cb(self, msg):
        self.packs = msg.data

    def enter(self, step, plan=()):
        self.step = step
        self.plan = list(plan)
        self.since = rospy.get_time()

    def drive(self):
        """Follow the plan; return the speeds of both axes and whether the plan is done."""
        speeds = {}
        goal = self.plan[0]
        for name, ramp in self.axes.items():
            rest = goal.goal - self.at[name] if name == goal.axis else 0.0
            speeds[name] = ramp.next(rest, 1.0 / self.rate)
        if abs(goal.goal - self.at[goal.axis]) < ARRIVED:
            self.plan.pop(0)
        return speeds

    def run(self, event):
        if self.at is None:
            return
        speeds = {"lift": 0.0, "travel": 0.0}
        force = GRIP_FORCE if self.step in ("grip", "carry") else 0.0
        waited = rospy.get_time() - self.since
        if self.plan:
            speeds = self.drive()
        elif self.step == "idle" and self.packs > 0:
            self.enter("grip")
        elif self.step == "grip":
            if self.jaws > 0.95 * GRIP_FORCE:
                top = self.layer * self.placed
                moves = Move("lift", self.height), Move("travel", self.pallet), Move("lift", top)
                self.enter("carry", moves)
            elif waited > GRIP_TIMEOUT:
                rospy.logerr("jaws reach only %.0f N", self.jaws)
                self.enter("idle")
        elif self.step == "carry":
            self.enter("release")
        elif self.step == "release" and self.jaws < 20.0 and waited > 0.3:
            self.placed += 1
            self.placed_pub.publish(self.placed)
            self.enter("return", [Move("lift", self.height), Move("travel", 0.0), Move("lift", 0.0)])
        elif self.step == "return":
            self.enter("idle")
        self.speed_pub.publish(Vector3(speeds["travel"], 0.0, speeds["lift"]))
        self.force_pub.publish(force)
        self.step_pub.publish(self.step)


if __name__ == "__main__":
    rospy.init_node("brick_gripper")
    Gripper()
    rospy.spin()
