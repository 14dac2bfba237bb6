#!/usr/bin/env python
"""Shifts the automated gearbox of a small bus: four gears, a dry clutch, and a shift that takes most of a second."""

import rospy
from std_msgs.msg import Bool, Float32, Int32, String

FIRST, TOP = 1, 4
SHIFT_TIME = 0.8  # s
CLUTCH_IN = 900.0  # rpm at which the clutch closes in the first gear


class Smooth(object):
    """Mean of a few readings."""

    def __init__(self, size):
        self.size = size
        self.values = []

    def add(self, value):
        self.values = self.values[1 - self.size :] + [value]

    @property
    def mean(self):
        return sum(self.values) / len(self.values) if self.values else 0.0


class Gearbox(object):
    def __init__(self):
        self.up_rpm = rospy.get_param("~up_rpm", 1900.0)
        self.down_rpm = rospy.get_param("~down_rpm", 1250.0)
        self.kick_down = rospy.get_param("~kick_down", 0.98)  # of the pedal
        self.dwell = rospy.get_param("~dwell", 1.5)  # s in a gear
        self.clutch_warning = rospy.get_param("~clutch_warning", 180.0)  # degrees C
        self.state = "hold"
        self.gear = FIRST
        self.wanted = FIRST
        self.since = rospy.get_time()
        self.rpm = Smooth(3)
        self.incline = Smooth(10)
        self.pedal = 0.0
        self.brake = True
        self.clutch = None
        self.shifts = 0
        self.gear_pub = rospy.Publisher("gearbox/gear", Int32, queue_size=1)
        self.clutch_pub = rospy.Publisher("gearbox/clutch_open", Bool, queue_size=1)
        self.dash_pub = rospy.Publisher("dashboard/gear", String, queue_size=1)
        for topic, kind, callback in (
            ("engine/rpm", Float32, lambda msg: self.rpm.add(msg.data)),
            ("body/incline", Float32, lambda msg: self.incline.add(msg.data)),
            ("driver/pedal", Float32, self.on_pedal),
            ("driver/brake", Bool, self.on_brake),
            ("clutch/temperature", Float32, self.on_clutch),
        ):
            rospy.Subscriber(topic, kind, callback)
        rospy.Timer(rospy.Duration(0.1), self.run)
        rospy.Timer(rospy.Duration(10.0), self.log)

    def on_pedal(self, msg):
        self.pedal = min(1.0, max(0.0, msg.data))

    def on_brake(self, msg):
        self.brake = msg.data

    def on_clutch(self, msg):
        if msg.data > self.clutch_warning:
            rospy.logwarn_throttle(10.0, "clutch has %.0f degrees", msg.data)
        self.clutch = msg.data

    def enter(self, state):
        self.state = state
        self.since = rospy.get_time()

    def choose(self):
        """Return the gear for the speed of the engine."""
        rpm = self.rpm.mean
        if rpm > self.up_rpm and self.gear < TOP and not self.brake:
            return self.gear + 1
        if rpm < self.down_rpm and self.gear > FIRST:
            return self.gear - 1
        return self.gear

    def run(self, event):
        spent = rospy.get_time() - self.since
        if self.state == "hold":
            if spent > self.dwell:
                self.wanted = self.choose()
                if self.wanted != self.gear:
                    self.shifts += 1
                    self.enter("open")
        elif self.state == "open":
            if spent >= 0.5 * SHIFT_TIME:
                self.gear = self.wanted
                self.enter("close")
        elif self.state == "close" and spent >= 0.5 * SHIFT_TIME:
            self.enter("hold")
        starting = self.gear == FIRST and self.rpm.mean < CLUTCH_IN and self.pedal < 0.05
        self.clutch_pub.publish(self.state != "hold" or starting)
        self.gear_pub.publish(self.gear)
        self.dash_pub.publish("%d%s" % (self.gear, "" if self.state == "hold" else "*"))

    def log(self, event):
        rospy.loginfo(
            "gear %d, %d shifts, incline %.1f %%", self.gear, self.shifts, 100.0 * self.incline.mean
        )


if __name__ == "__main__":
    rospy.init_node("bus_gearbox")
    Gearbox()
    rospy.spin()
