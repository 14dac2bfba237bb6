#!/usr/bin/env python
"""Rakes a beach in lanes, to and fro, from the promenade towards the hotels. Steers by the gyroscope and the wheels."""

import math

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, Float32, String


def wrap(angle):
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


class BeachRake(object):
    def __init__(self):
        self.lane = rospy.get_param("~lane", 6.0)  # m
        self.shift = rospy.get_param("~shift", 1.0)
        self.lanes = rospy.get_param("~lanes", 4)
        self.speed = rospy.get_param("~speed", 0.6)  # m/s
        self.shift_speed = rospy.get_param("~shift_speed", 0.4)
        self.k_heading = rospy.get_param("~k_heading", 1.6)
        self.max_turn = rospy.get_param("~max_turn", 0.8)  # rad/s
        self.aligned = rospy.get_param("~aligned", 0.05)  # rad
        self.settle = rospy.get_param("~settle", 20)  # samples for the bias of the gyroscope
        self.tilt_limit = rospy.get_param("~tilt_limit", 0.35)
        self.wheel_scale = rospy.get_param("~wheel_scale", 1.0)
        self.legs = self.plan()
        self.leg = 0
        self.turning = False
        self.heading = 0.0
        self.distance = 0.0
        self.bias = 0.0
        self.samples = 0
        self.tilted = False
        self.last_imu = None
        self.cmd = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.rake = rospy.Publisher("rake/down", Bool, queue_size=1)
        self.status = rospy.Publisher("rake/status", String, queue_size=1)
        rospy.Subscriber("imu", Imu, self.imu_cb)
        rospy.Subscriber("wheel/speed", Float32, self.wheel_cb)

    def plan(self):
        """List of legs: heading, length, rake down or not."""
        legs = []
        for lane in range(self.lanes):
            legs.append((0.0 if lane % 2 == 0 else math.pi, self.lane, True))
            if lane < self.lanes - 1:
                legs.append((math.pi / 2.0, self.shift, False))
        return legs

    def imu_cb(self, msg):
        rate = msg.angular_velocity.z
        now = rospy.get_time()
        if self.samples < self.settle:
            # stands still, learn the bias
            self.samples += 1
            self.bias += (rate - self.bias) / self.samples
        elif self.last_imu is not None:
            self.heading = wrap(self.heading + (rate - self.bias) * (now - self.last_imu))
        self.last_imu = now
        lean = math.hypot(msg.linear_acceleration.x, msg.linear_acceleration.y)
        self.tilted = lean > 9.81 * math.sin(self.tilt_limit)

    def wheel_cb(self, msg):
        if not self.turning and self.samples >= self.settle:
            self.distance += 0.1 * self.wheel_scale * msg.data

    def step(self):
        out = Twist()
        down = False
        if self.samples < self.settle:
            self.status.publish("settling")
        elif self.tilted:
            rospy.logwarn_throttle(5.0, "too steep, waiting")
            self.status.publish("tilted")
        elif self.leg >= len(self.legs):
            self.status.publish("done")
        else:
            goal, length, down = self.legs[self.leg]
            error = wrap(goal - self.heading)
            out.angular.z = max(-self.max_turn, min(self.max_turn, self.k_heading * error))
            if self.turning:
                down = False
                self.turning = abs(error) > self.aligned
            else:
                out.linear.x = self.speed if down else self.shift_speed
                if self.distance >= length:
                    self.distance = 0.0
                    self.leg += 1
                    self.turning = True
                    out.linear.x = 0.0
            self.status.publish("leg %d" % self.leg)
        self.cmd.publish(out)
        self.rake.publish(down)


if __name__ == "__main__":
    rospy.init_node("beach_rake")
    rake = BeachRake()
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        rake.step()
        rate.sleep()
