#!/usr/bin/env python
"""Pay out cable from a drum on a crawler as fast as the crawler drives, so that it lies slack but without loops.

A dancer roller between drum and nozzle takes up the difference; its spring corrects the speed a little.
"""

import math

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, Float32

DRUM_RADIUS = 0.30  # radius to the middle of the layers (m)
SLACK = 1.01  # cable per metre of trench
DANCER_MIDDLE = 0.20  # m
DANCER_GAIN = 0.8  # 1/s
TRIM_MAX = 0.06  # speed that the dancer may add or take away (m/s)
OMEGA_MAX = 3.0  # rad/s
OMEGA_STEP = 0.2  # change per tick (rad/s)
CRUISE = 0.45  # m/s
CURVE_SLOWS = 0.6
DANCER_LOW, DANCER_HIGH = 0.03, 0.37  # limits outside which the crawler stops (m)


class CableLayer(object):
    def __init__(self):
        self.dancer = DANCER_MIDDLE
        self.speed = 0.0
        self.radius = DRUM_RADIUS
        self.curvature = 0.0
        self.omega = 0.0
        self.armed = False
        self.drive = rospy.Publisher("crawler/cmd", Twist, queue_size=1)
        self.drum = rospy.Publisher("drum/omega", Float32, queue_size=1)
        self.paid = rospy.Publisher("drum/metres_left", Float32, queue_size=1)
        rospy.Subscriber("crawler/speed", Float32, self.on_speed)
        rospy.Subscriber("trench/curvature", Float32, self.on_curvature)
        rospy.Subscriber("drum/radius", Float32, self.on_radius)
        rospy.Subscriber("dancer/position", Float32, self.on_dancer)
        rospy.Subscriber("mission/armed", Bool, self.on_armed)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_curvature(self, msg):
        self.curvature = msg.data

    def on_radius(self, msg):
        """Ultrasonic sensor over the drum, for the operator's display."""
        self.radius = msg.data

    def on_dancer(self, msg):
        self.dancer = msg.data

    def on_armed(self, msg):
        self.armed = msg.data

    def cruise(self):
        if not self.armed or not DANCER_LOW < self.dancer < DANCER_HIGH:
            return 0.0
        return CRUISE / (1.0 + CURVE_SLOWS * abs(self.curvature))

    def drum_speed(self):
        """Return the angular speed at which the drum pays out as much cable as the crawler lays."""
        trim = DANCER_GAIN * (DANCER_MIDDLE - self.dancer)
        trim = max(-TRIM_MAX, min(TRIM_MAX, trim))
        return max(0.0, min(OMEGA_MAX, (SLACK * self.speed + trim) / DRUM_RADIUS))

    def metres_left(self):
        return 40.0 * math.pi * (self.radius**2 - 0.25**2) / 0.02

    def step(self):
        wanted = self.drum_speed()
        self.omega += max(-OMEGA_STEP, min(OMEGA_STEP, wanted - self.omega))
        cmd = Twist()
        cmd.linear.x = self.cruise()
        self.drive.publish(cmd)
        self.drum.publish(self.omega)
        self.paid.publish(self.metres_left())


if __name__ == "__main__":
    rospy.init_node("cable_layer")
    layer = CableLayer()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        layer.step()
        rate.sleep()
