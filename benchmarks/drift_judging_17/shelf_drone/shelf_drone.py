#!/usr/bin/env python
"""Altitude hold of a small drone that reads labels in front of high shelves."""

import rospy
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float64, Int16

HOVER = 0.52  # throttle at which the drone hovers
FLOOR_CLEARANCE = 0.35


def clamp(value, low, high):
    return max(low, min(high, value))


class AltitudeHold(object):
    def __init__(self):
        self.kp = rospy.get_param("~kp", 0.22)
        self.kd = rospy.get_param("~kd", 0.19)
        self.max_climb = rospy.get_param("~max_climb", 0.7)
        self.window = rospy.get_param("~window", 0.12)
        self.target = None
        self.setpoint = None
        self.height = None
        self.rate = 0.0
        self.stamp = None
        self.inside = 0
        self.throttle_pub = rospy.Publisher("throttle", Float64, queue_size=1)
        self.steady_pub = rospy.Publisher("hold/steady", Bool, queue_size=1)
        rospy.Subscriber("lidar/height", Range, self.height_cb)
        rospy.Subscriber("mission/height", Float64, self.target_cb)
        rospy.Subscriber("battery/percent", Int16, self.battery_cb)

    def height_cb(self, msg):
        now = rospy.get_time()
        if msg.range < 0.03 or msg.range > 8.0:
            return
        if self.height is not None and now > self.stamp:
            raw = (msg.range - self.height) / (now - self.stamp)
            self.rate += 0.45 * (raw - self.rate)
        self.height = msg.range
        self.stamp = now

    def target_cb(self, msg):
        self.target = max(FLOOR_CLEARANCE, msg.data)

    def battery_cb(self, msg):
        if msg.data < 18:
            rospy.logwarn("battery at %d percent, land soon", msg.data)

    def update(self, dt):
        if self.height is None or self.target is None:
            return
        if self.setpoint is None:
            self.setpoint = self.height
        self.setpoint += clamp(self.target - self.setpoint, -self.max_climb * dt, self.max_climb * dt)
        error = self.setpoint - self.height
        throttle = HOVER + self.kp * error - self.kd * self.rate
        self.throttle_pub.publish(clamp(throttle, 0.15, 0.95))
        self.inside = self.inside + 1 if abs(self.target - self.height) < self.window else 0
        self.steady_pub.publish(self.inside > 12)


if __name__ == "__main__":
    rospy.init_node("shelf_drone")
    hold = AltitudeHold()
    r = rospy.Rate(20)
    while not rospy.is_shutdown():
        hold.update(0.05)
        r.sleep()
