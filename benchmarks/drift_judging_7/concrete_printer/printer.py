#!/usr/bin/env python
"""Print a wall of concrete: drive the gantry along the layer and the screw pump at a rate that matches."""

import threading

import rospy
from std_msgs.msg import Float64

LITRES_PER_TURN = 0.031
BEAD = {"width": 0.05, "height": 0.015}  # m


class Printer:
    def __init__(self):
        self.lock = threading.Lock()
        self.curvature = 0.0
        self.straight_speed = rospy.get_param("~straight_speed", 0.12)
        self.bend_speed = rospy.get_param("~bend_speed", 0.07)
        self.pub_speed = rospy.Publisher("gantry/speed", Float64, queue_size=1)
        self.pub_pump = rospy.Publisher("pump/turns_per_s", Float64, queue_size=1)
        rospy.Subscriber("path/curvature", Float64, self.cb_path)
        rospy.Timer(rospy.Duration(0.2), self.cb_timer)

    def cb_path(self, msg):
        with self.lock:
            self.curvature = msg.data

    def flow(self, speed):
        """Return the litres per second for a bead at this speed."""
        return BEAD["width"] * BEAD["height"] * speed * 1000.0

    def cb_timer(self, _event):
        with self.lock:
            bend = abs(self.curvature) > 1.0
        speed = self.bend_speed if bend else self.straight_speed
        turns = self.flow(speed) / LITRES_PER_TURN
        self.pub_speed.publish(speed)
        self.pub_pump.publish(turns)


if __name__ == "__main__":
    rospy.init_node("concrete_printer")
    Printer()
    rospy.spin()
