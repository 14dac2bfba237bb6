#!/usr/bin/env python
"""Keeps a bird in the middle of the picture of a camera on a pan-tilt head."""

import math

import rospy
from geometry_msgs.msg import PointStamped, Twist
from sensor_msgs.msg import JointState
from std_msgs.msg import Float32, String

WIDTH, HEIGHT = 1280, 720
H_FOV = math.radians(52.0)
V_FOV = math.radians(31.0)

AXES = {
    "pan": {"kp": 2.2, "kd": 0.05, "max_rate": 0.9, "low": -2.6, "high": 2.6},
    "tilt": {"kp": 2.2, "kd": 0.05, "max_rate": 0.9, "low": -0.4, "high": 1.2},
}


class Axis(object):
    def __init__(self, name):
        gains = AXES[name]
        self.kp = gains["kp"]
        self.kd = gains["kd"]
        self.max_rate = gains["max_rate"]
        self.low, self.high = gains["low"], gains["high"]
        self.previous = 0.0
        self.position = 0.0

    def rate(self, error, dt):
        derivative = (error - self.previous) / dt
        self.previous = error
        out = self.kp * error + self.kd * derivative
        if self.position > self.high:
            out = min(out, 0.0)
        elif self.position < self.low:
            out = max(out, 0.0)
        return max(-self.max_rate, min(self.max_rate, out))


class ZoomTurret(object):
    def __init__(self):
        self.deadband = rospy.get_param("~deadband_px", 4.0)
        self.lost_after = rospy.get_param("~lost_after", 1.0)
        self.period = rospy.get_param("~period", 0.1)
        self.pan, self.tilt = Axis("pan"), Axis("tilt")
        self.target = None
        self.last_seen = None
        self.zoom = 1.0
        self.cmd_pub = rospy.Publisher("head/rates", Twist, queue_size=1)
        self.overlay_pub = rospy.Publisher("overlay", String, queue_size=1)
        rospy.Subscriber("tracker/target", PointStamped, self.target_cb, queue_size=1)
        rospy.Subscriber("head/joints", JointState, self.joints_cb, queue_size=1)
        rospy.Subscriber("camera/zoom", Float32, self.zoom_cb, queue_size=1)

    def joints_cb(self, msg):
        self.pan.position, self.tilt.position = msg.position[0], msg.position[1]

    def zoom_cb(self, msg):
        self.zoom = msg.data
        self.overlay_pub.publish("%.1fx" % self.zoom)

    def target_cb(self, msg):
        self.target = (msg.point.x, msg.point.y)
        self.last_seen = rospy.Time.now()

    def offset(self):
        """Error in pixels, with a dead band."""
        right = self.target[0] - WIDTH / 2.0
        up = HEIGHT / 2.0 - self.target[1]
        if abs(right) < self.deadband:
            right = 0.0
        if abs(up) < self.deadband:
            up = 0.0
        return right, up

    def step(self):
        cmd = Twist()
        if self.last_seen is None or (rospy.Time.now() - self.last_seen).to_sec() > self.lost_after:
            self.cmd_pub.publish(cmd)
            return
        right, up = self.offset()
        cmd.angular.z = self.pan.rate(right * H_FOV / WIDTH, self.period)
        cmd.angular.y = self.tilt.rate(up * V_FOV / HEIGHT, self.period)
        self.cmd_pub.publish(cmd)

    def run(self):
        rate = rospy.Rate(1.0 / self.period)
        while not rospy.is_shutdown():
            self.step()
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("zoom_turret")
    ZoomTurret().run()
