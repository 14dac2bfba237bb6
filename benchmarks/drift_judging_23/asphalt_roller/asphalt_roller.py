#!/usr/bin/env python
"""Tandem roller behind a paver: waits until the mat bears the drum, rolls the lane back and forth, and leaves it.

Breakdown passes vibrate, finish passes are static. Temperatures are in degrees Celsius, positions in m along the lane.
"""

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Temperature
from std_msgs.msg import Float32, String

PASSES = (
    # vibration amplitude in mm, speed in m/s
    (0.7, 1.2),
    (0.7, 1.2),
    (0.4, 1.3),
    (0.4, 1.3),
    (0.0, 1.5),
    (0.0, 1.5),
)


class AsphaltRoller(object):
    WAITING = "waiting"
    ROLLING = "rolling"
    PARKED = "parked"

    def __init__(self):
        self.roll_below = rospy.get_param("~roll_below", 134.0)
        self.cease_below = rospy.get_param("~cease_below", 70.0)
        self.lane = rospy.get_param("~lane_length", 48.0)
        self.margin = rospy.get_param("~turn_margin", 1.5)  # m before the end at which the drum reverses
        self.ramp = rospy.get_param("~ramp", 0.4)  # m/s per s; a harder start leaves a dent
        self.smoothing = rospy.get_param("~ir_smoothing", 0.3)
        self.state = self.WAITING
        self.index = 0
        self.position = 0.0
        self.speed = 0.0
        self.mat = None
        self.base = None

        self.cmd_pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.vibration_pub = rospy.Publisher("drum/amplitude", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("roller/state", String, queue_size=1)
        rospy.Subscriber("mat/temperature", Temperature, self.mat_cb)
        rospy.Subscriber("base/temperature", Temperature, self.base_cb)
        rospy.Subscriber("roller/position", Float32, self.position_cb)
        self.period = 1.0
        rospy.Timer(rospy.Duration(self.period), self.update)

    def mat_cb(self, msg):
        # the drum sprays water, so single readings of the infrared sensor are off
        if self.mat is None:
            self.mat = msg.temperature
        self.mat += self.smoothing * (msg.temperature - self.mat)

    def base_cb(self, msg):
        if self.base is None:
            rospy.loginfo("base course at %.1f degrees", msg.temperature)
        self.base = msg.temperature

    def position_cb(self, msg):
        self.position = msg.data

    def forward(self):
        return self.index % 2 == 0

    def at_end(self):
        if self.forward():
            return self.position > self.lane - self.margin
        return self.position < self.margin

    def drive(self, wanted):
        step = self.ramp * self.period
        self.speed += max(-step, min(step, wanted - self.speed))
        twist = Twist()
        twist.linear.x = self.speed
        self.cmd_pub.publish(twist)

    def update(self, event):
        if self.mat is None:
            return
        amplitude = 0.0
        wanted = 0.0
        if self.state == self.WAITING:
            if self.mat < self.roll_below:
                rospy.loginfo("mat at %.0f degrees, start", self.mat)
                self.state = self.ROLLING
        elif self.state == self.ROLLING:
            if self.at_end():
                self.index += 1
            if self.index == len(PASSES) or self.mat < self.cease_below:
                self.state = self.PARKED
            else:
                amplitude, wanted = PASSES[self.index]
                if not self.forward():
                    wanted = -wanted
        self.drive(wanted)
        # never vibrate a standing drum
        self.vibration_pub.publish(amplitude if abs(self.speed) > 0.5 else 0.0)
        self.state_pub.publish(self.state)


if __name__ == "__main__":
    rospy.init_node("asphalt_roller")
    AsphaltRoller()
    rospy.spin()
