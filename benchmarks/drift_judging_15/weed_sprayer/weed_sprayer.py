#!/usr/bin/env python
"""Sprays weeds that a camera on the front of a tractor has detected.

Each detection is a pixel. It is projected on the ground, put into a queue, and sprayed when a nozzle is above it.
"""

import math
from collections import deque

import rospy
from geometry_msgs.msg import Point, TwistStamped
from std_msgs.msg import Float32, UInt8

IMAGE = {"width": 640, "height": 480, "fx": 420.0, "fy": 420.0}

# camera above the ground, in front of the boom
CAMERA_HEIGHT = 0.95  # m
CAMERA_PITCH = 0.62  # angle below the horizon (rad)
CAMERA_TO_BOOM = 0.40  # m

NOZZLE_SPACING = 0.25  # m
NOZZLES = 3


def ground(u, v):
    """Distance ahead of the camera and to the left, in m."""
    down = CAMERA_PITCH + math.atan2(v - IMAGE["height"] / 2.0, IMAGE["fy"])
    ahead = CAMERA_HEIGHT / math.tan(down)
    ray = math.hypot(ahead, CAMERA_HEIGHT)
    left = -(u - IMAGE["width"] / 2.0) / IMAGE["fx"] * ray
    return ahead, left


class Target(object):
    def __init__(self, position, nozzle):
        self.position = position
        self.nozzle = nozzle


class WeedSprayer(object):
    def __init__(self):
        self.valve_delay = rospy.get_param("~valve_delay", 0.08)
        self.spray_length = rospy.get_param("~spray_length", 0.20)
        self.min_speed = rospy.get_param("~min_speed", 0.2)
        self.max_range = rospy.get_param("~max_range", 2.5)
        self.confidence = rospy.get_param("~confidence", 0.5)
        self.odometer = 0.0
        self.speed = 0.0
        self.stamp = None
        self.pressure = 2.5
        self.targets = deque(maxlen=50)
        self.valves = rospy.Publisher("boom/valves", UInt8, queue_size=1)
        rospy.Subscriber("weeds", Point, self.weed_cb, queue_size=20)
        rospy.Subscriber("gps/velocity", TwistStamped, self.speed_cb)
        rospy.Subscriber("boom/pressure", Float32, self.pressure_cb)
        rospy.Timer(rospy.Duration(0.05), self.update)

    def speed_cb(self, msg):
        now = rospy.Time.now()
        if self.stamp is not None:
            self.odometer += self.speed * (now - self.stamp).to_sec()
        self.stamp = now
        self.speed = 0.6 * self.speed + 0.4 * msg.twist.linear.x

    def pressure_cb(self, msg):
        self.pressure = msg.data
        if self.pressure < 1.5:
            rospy.logwarn_throttle(10.0, "boom pressure %.1f bar" % self.pressure)

    def weed_cb(self, msg):
        if msg.z < self.confidence:
            return
        ahead, left = ground(msg.x, msg.y)
        if ahead > self.max_range:
            return
        nozzle = int(round(left / NOZZLE_SPACING)) + NOZZLES // 2
        if 0 <= nozzle < NOZZLES:
            self.targets.append(Target(self.odometer + ahead + CAMERA_TO_BOOM, nozzle))

    def update(self, _event):
        mask = 0
        if self.speed > self.min_speed:
            reach = self.odometer + self.speed * self.valve_delay
            for target in self.targets:
                if abs(target.position - reach) < self.spray_length / 2.0:
                    mask |= 1 << target.nozzle
            while self.targets and self.targets[0].position < reach - 1.0:
                self.targets.popleft()
        self.valves.publish(UInt8(mask))


if __name__ == "__main__":
    rospy.init_node("weed_sprayer")
    WeedSprayer()
    rospy.spin()
