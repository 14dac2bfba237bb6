#!/usr/bin/env python
"""Holds the level of a mill pond with the gate of its weir."""

import math

import rospy
from std_msgs.msg import Float32, Float64, String

DEFAULTS = {
    "level": 1.5,  # m
    "flood": 1.9,  # m
    "gate_per_metre": 1.6,  # m of gate per m of level
    "base_opening": 0.25,  # m
    "gate_min": 0.02,
    "gate_max": 0.9,
    "motor_gain": 1.5,  # speed of the motor per m
    "motor_speed": 1.0,
}


class Weir:
    def __init__(self):
        for name, value in DEFAULTS.items():
            setattr(self, name, float(rospy.get_param("~" + name, value)))
        self.measured = None
        self.gate = None
        self.rain = 0.0
        self.level_max = -math.inf
        self.motor = rospy.Publisher("gate/motor", Float64, queue_size=1)
        self.status = rospy.Publisher("weir/status", String, queue_size=1)
        self.alarm = rospy.Publisher("weir/alarm", String, queue_size=1)

    def level_received(self, msg):
        if math.isnan(msg.data):
            rospy.logwarn("gauge without a value")
            return
        self.measured = msg.data
        if msg.data > self.level_max:
            self.level_max = msg.data

    def gate_received(self, msg):
        self.gate = msg.data

    def rain_received(self, msg):
        self.rain = max(0.0, msg.data)

    def opening(self):
        """Return the opening of the gate in m for the present level."""
        over = self.measured - self.level
        wanted = self.base_opening + self.gate_per_metre * over
        return min(self.gate_max, max(self.gate_min, wanted))

    def motor_command(self, wanted):
        """Return the speed of the motor that brings the gate to an opening."""
        rest = wanted - self.gate
        speed = self.motor_gain * rest
        return max(-self.motor_speed, min(self.motor_speed, speed))

    def control(self, event):
        if self.measured is None or self.gate is None:
            return
        if self.measured > self.flood:
            self.alarm.publish("%.2f m" % self.measured)
            wanted = self.gate_max
        else:
            wanted = self.opening()
        self.motor.publish(self.motor_command(wanted))

    def report(self, event):
        if self.measured is None or self.gate is None:
            return
        text = "level %.2f (highest %.2f) m, gate %.2f m, rain %.1f mm/h"
        self.status.publish(text % (self.measured, self.level_max, self.gate, self.rain))


def main():
    rospy.init_node("pond_weir")
    weir = Weir()
    rospy.Subscriber("pond/level", Float32, weir.level_received)
    rospy.Subscriber("gate/position", Float32, weir.gate_received)
    rospy.Subscriber("weather/rain", Float32, weir.rain_received)
    rospy.Timer(rospy.Duration(2.0), weir.control)
    rospy.Timer(rospy.Duration(60.0), weir.report)
    rospy.spin()


if __name__ == "__main__":
    main()
