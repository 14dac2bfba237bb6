#!/usr/bin/env python
"""Yaws the nacelle of a small wind turbine into the wind and untwists its cable."""

import math

import rospy
from geometry_msgs.msg import Vector3
from std_msgs.msg import Float32, String

PARAMS = dict(
    k_yaw=0.12,  # 1/s
    max_rate=1.4,  # deg/s
    start_wind=3.0,  # m/s
    stop_wind=2.2,
    storm_wind=22.0,
    twist_limit=900.0,  # deg
    untwist_rate=0.5,
    period=1.0,
)


def wrapped(angle):
    """Return an angle between -180 and 180 degrees."""
    return (angle + 180.0) % 360.0 - 180.0


class Vane:
    """Wind as seen from the nacelle; the vane sits behind the rotor, which deflects it a little."""

    DEFLECTION = 1.2  # deg

    def __init__(self):
        self.angle = 0.0
        self.wind = 0.0
        rospy.Subscriber("nacelle/wind", Vector3, self.callback)

    def callback(self, msg):
        self.angle = math.degrees(math.atan2(msg.y, msg.x)) - self.DEFLECTION
        self.wind += 0.1 * (math.hypot(msg.x, msg.y) - self.wind)


class YawController:
    def __init__(self, vane):
        self.vane = vane
        self.p = {key: rospy.get_param("~" + key, value) for key, value in PARAMS.items()}
        self.running = False
        self.untwisting = False
        self.twist = 0.0
        self.drive = rospy.Publisher("yaw_drive/rate", Float32, queue_size=1)
        self.status = rospy.Publisher("turbine/status", String, queue_size=1)
        rospy.Subscriber("nacelle/twist", Float32, self.twist_callback)

    def twist_callback(self, msg):
        self.twist = msg.data
        if abs(self.twist) > self.p["twist_limit"]:
            self.untwisting = True
        elif abs(self.twist) < 20.0:
            self.untwisting = False

    def select(self):
        if self.vane.wind > self.p["storm_wind"]:
            self.running = False
            return "storm"
        if self.vane.wind > self.p["start_wind"]:
            self.running = True
        elif self.vane.wind < self.p["stop_wind"]:
            self.running = False
        return "running" if self.running else "calm"

    def rate(self):
        if self.untwisting:
            return -math.copysign(self.p["untwist_rate"], self.twist)
        error = wrapped(self.vane.angle)
        rate = self.p["k_yaw"] * error
        return max(-self.p["max_rate"], min(self.p["max_rate"], rate))

    def on_timer(self, _event):
        mode = self.select()
        self.status.publish(mode)
        if mode == "running" or self.untwisting:
            self.drive.publish(self.rate())
        else:
            self.drive.publish(0.0)


rospy.init_node("nacelle_yaw")
controller = YawController(Vane())
rospy.Timer(rospy.Duration(controller.p["period"]), controller.on_timer)
rospy.spin()
