#!/usr/bin/env python
"""Keep a two-wheeled robot upright and let it follow velocity commands.

Cascade: the speed loop leans the body, the pitch loop accelerates the wheels.
"""

import math

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu
from std_msgs.msg import Float64

BALANCE_ANGLE = -0.012  # pitch at which the body stands by itself (rad)
PITCH_KP = 42.0
PITCH_KD = 6.5
SPEED_KP = 0.10
MAX_LEAN = 0.12  # rad
MAX_ACCEL = 9.0  # m/s^2
FALLEN = 0.7  # rad


def clamp(value, limit):
    return max(-limit, min(limit, value))


class Balancer(object):
    def __init__(self):
        self.speed = 0.0
        self.wanted = 0.0
        self.armed = False
        self.pub = rospy.Publisher("wheels/accel", Float64, queue_size=1)
        rospy.Subscriber("cmd_vel", Twist, self.cmd_cb)
        rospy.Subscriber("odom", Odometry, self.odom_cb)
        rospy.Subscriber("imu", Imu, self.imu_cb)

    def cmd_cb(self, msg):
        self.wanted = msg.linear.x
        self.armed = True

    def odom_cb(self, msg):
        self.speed = msg.twist.twist.linear.x

    def imu_cb(self, msg):
        if not self.armed:
            return
        q = msg.orientation
        pitch = math.asin(max(-1.0, min(1.0, 2.0 * (q.w * q.y - q.z * q.x))))
        if abs(pitch) > FALLEN:
            self.pub.publish(Float64(0.0))
            return
        lean = clamp(SPEED_KP * (self.wanted - self.speed), MAX_LEAN)
        error = pitch - (BALANCE_ANGLE + lean)
        accel = PITCH_KP * error + PITCH_KD * msg.angular_velocity.y
        self.pub.publish(Float64(clamp(accel, MAX_ACCEL)))


if __name__ == "__main__":
    rospy.init_node("balancer")
    Balancer()
    rospy.spin()
