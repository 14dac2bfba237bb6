#!/usr/bin/env python3
"""Drill the holes for anchors into a concrete ceiling."""

import rospy
from geometry_msgs.msg import Vector3
from std_msgs.msg import Bool, Float64

PARAMS = {"thrust": 160.0, "soft_thrust": 60.0, "soft_depth": 4.0, "hot": 85.0, "cool_thrust": 90.0}


class Driller:
    def __init__(self, params):
        self.p = params
        self.depth = 0.0
        self.heat = 20.0
        self.phase = "start"
        self.command = rospy.Publisher("drill/command", Vector3, queue_size=1)
        self.finished = rospy.Publisher("drill/finished", Bool, queue_size=1)

    def depth_callback(self, msg):
        self.depth = msg.data

    def heat_callback(self, msg):
        self.heat = msg.data

    def next_phase(self):
        if self.phase == "start" and self.depth > self.p["soft_depth"]:
            self.phase = "drill"
        if self.depth >= rospy.get_param("~depth", 40.0):
            self.phase = "back"

    def thrust(self):
        if self.phase == "start":
            return self.p["soft_thrust"]
        return self.p["cool_thrust"] if self.heat > self.p["hot"] else self.p["thrust"]

    def step(self, _event):
        self.next_phase()
        if self.phase == "back":
            self.command.publish(Vector3(0.0, 0.0, 0.0))
            self.finished.publish(Bool(True))
        else:
            self.command.publish(Vector3(self.thrust(), 740.0, 0.0))


if __name__ == "__main__":
    rospy.init_node("wall_driller")
    driller = Driller({key: rospy.get_param("~" + key, value) for key, value in PARAMS.items()})
    rospy.Subscriber("drill/depth", Float64, driller.depth_callback)
    rospy.Subscriber("drill/temperature", Float64, driller.heat_callback)
    rospy.Timer(rospy.Duration(0.2), driller.step)
    rospy.spin()
