#!/usr/bin/env python
"""Pantograph of a test train: raises the head to the wire, holds the air in its bellows, and lowers it at the end."""

import rospy
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Bool, Float32, String

PERIOD = 0.2  # s


class Pantograph(object):
    DOWN, RAISING, RUNNING, LOWERING = "down", "raising", "running", "lowering"

    def __init__(self):
        self.state = self.DOWN
        self.pressure = None  # Pa
        self.speed = 0.0  # m/s
        self.permit = False
        self.contact = False
        self.integral = 0.0
        self.static_force = rospy.get_param("~static_force", 80.0)  # N
        self.head_weight = rospy.get_param("~head_weight", 55.0)  # N
        self.raise_force = rospy.get_param("~raise_force", 30.0)  # N more than the weight
        self.area = rospy.get_param("~area", 0.0006)  # m2, of the bellows through the linkage
        self.kp = rospy.get_param("~kp", 0.000004)  # valve per Pa
        self.ki = rospy.get_param("~ki", 0.0000015)
        self.raise_below = rospy.get_param("~raise_below", 12.0)  # m/s
        self.valve_pub = rospy.Publisher("bellows/valve", Float32, queue_size=1)
        self.state_pub = rospy.Publisher("pantograph/state", String, queue_size=1)
        self.power_pub = rospy.Publisher("pantograph/power", Bool, queue_size=1)
        rospy.Subscriber("bellows/pressure", FluidPressure, self.pressure_cb)
        rospy.Subscriber("train/velocity", TwistStamped, self.velocity_cb)
        rospy.Subscriber("driver/permit", Bool, self.permit_cb)
        rospy.Subscriber("head/contact", Bool, self.contact_cb)
        self.timer = rospy.Timer(rospy.Duration(PERIOD), self.update)

    def pressure_cb(self, msg):
        self.pressure = msg.fluid_pressure

    def velocity_cb(self, msg):
        self.speed = msg.twist.linear.x

    def permit_cb(self, msg):
        self.permit = msg.data

    def contact_cb(self, msg):
        self.contact = msg.data

    def next_state(self):
        if not self.permit and self.state in (self.RAISING, self.RUNNING):
            rospy.loginfo("no permit, lowering")
            return self.LOWERING
        if self.state == self.DOWN and self.permit and self.speed < self.raise_below:
            return self.RAISING
        if self.state == self.RAISING and self.contact:
            self.integral = 0.0
            return self.RUNNING
        if self.state == self.LOWERING and not self.contact:
            return self.DOWN
        return self.state

    def wanted(self):
        """Pressure for the state that we are in."""
        if self.state == self.RAISING:
            return (self.head_weight + self.raise_force) / self.area
        if self.state == self.RUNNING:
            return (self.head_weight + self.static_force) / self.area
        return 0.0

    def update(self, event):
        if self.pressure is None:
            return
        self.state = self.next_state()
        error = self.wanted() - self.pressure
        if self.state == self.RUNNING:
            self.integral += error * PERIOD
        valve = self.kp * error + self.ki * self.integral
        self.valve_pub.publish(max(-1.0, min(1.0, valve)))
        self.power_pub.publish(self.state == self.RUNNING and self.contact)
        self.state_pub.publish(self.state)


def main():
    rospy.init_node("pantograph")
    Pantograph()
    rospy.spin()


if __name__ == "__main__":
    main()
