#!/usr/bin/env python
"""Draws on a wall with a pen that hangs from two cords: winches at two anchors of equal height set their lengths.

The origin is the left anchor; x points to the right one, y down. All lengths are in m.
"""

import math

import rospy
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import Bool, String

PENS = {"graphite": 0.4, "marker": 0.25}  # s that a pen needs to be lowered
MAX_CORD_SPEED = 0.4


class MuralPlotter(object):
    IDLE, TRAVEL, LOWER, DRAW, FINISHED = "idle", "travel", "lower", "draw", "finished"

    def __init__(self):
        self.anchors = rospy.get_param("~anchor_distance")
        self.lower_time = PENS[rospy.get_param("~pen")]
        self.draw_speed = rospy.get_param("~draw_speed")
        self.travel_speed = rospy.get_param("~travel_speed")
        self.gain = rospy.get_param("~cord_gain")
        self.close_enough = rospy.get_param("~close_enough")
        self.state = self.IDLE
        self.since = rospy.get_time()
        self.points = []
        self.complete = False
        self.carrot = None  # where the pen should be now
        self.cords = None
        self.period = 0.1
        self.winch_pub = rospy.Publisher("winches/speed", Vector3, queue_size=1)
        self.pen_pub = rospy.Publisher("pen/down", Bool, queue_size=1)
        self.state_pub = rospy.Publisher("plotter/state", String, queue_size=1)
        rospy.Subscriber("winches/length", Vector3, self.on_length)
        rospy.Subscriber("drawing/point", Point, self.on_point)
        rospy.Subscriber("drawing/complete", Bool, self.on_complete)
        rospy.Timer(rospy.Duration(self.period), self.update)

    def on_length(self, msg):
        self.cords = (msg.x, msg.y)

    def on_point(self, msg):
        self.points.append((msg.x, msg.y))

    def on_complete(self, msg):
        self.complete = msg.data

    def lengths(self, x, y):
        """Return the lengths of the cords for a place of the pen."""
        return math.hypot(x, y), math.hypot(self.anchors - x, y)

    def place(self):
        """Return the place of the pen for the present lengths of the cords."""
        left, right = self.cords
        x = (left**2 - right**2 + self.anchors**2) / (2.0 * self.anchors)
        return x, math.sqrt(max(0.0, left**2 - x**2))

    def enter(self, state):
        self.state = state
        self.since = rospy.get_time()

    def step(self, speed):
        """Move the carrot towards the next point; return whether it and the pen are there."""
        x, y = self.carrot
        to_x, to_y = self.points[0]
        left = math.hypot(to_x - x, to_y - y)
        way = speed * self.period
        if left > way:
            self.carrot = (x + way * (to_x - x) / left, y + way * (to_y - y) / left)
            return False
        self.carrot = self.points[0]
        at = self.place()
        return math.hypot(at[0] - to_x, at[1] - to_y) < self.close_enough

    def update(self, event):
        if self.cords is None:
            return
        if self.carrot is None:
            self.carrot = self.place()
        if self.state == self.IDLE:
            if self.complete and self.points:
                self.enter(self.TRAVEL)
        elif self.state == self.TRAVEL:
            if self.step(self.travel_speed):
                self.points.pop(0)
                self.enter(self.LOWER)
        elif self.state == self.LOWER:
            if rospy.get_time() - self.since > self.lower_time:
                self.enter(self.DRAW)
        elif self.state == self.DRAW:
            if not self.points:
                self.enter(self.FINISHED)
            elif self.step(self.draw_speed):
                self.points.pop(0)
        wanted = self.lengths(*self.carrot)
        speeds = [self.gain * (want - have) for want, have in zip(wanted, self.cords)]
        speeds = [max(-MAX_CORD_SPEED, min(MAX_CORD_SPEED, speed)) for speed in speeds]
        self.winch_pub.publish(Vector3(speeds[0], speeds[1], 0.0))
        self.pen_pub.publish(self.state == self.DRAW)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("mural_plotter")
    MuralPlotter()
    rospy.spin()
