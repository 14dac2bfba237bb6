#!/usr/bin/env python3
"""Moves a camera on a cable above a running track, beside the athletes."""

import rclpy
from geometry_msgs.msg import PointStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64, Float64MultiArray
from winch_pid import PID

TRACK = (2.0, 98.0)  # ends of the usable cable (m)
LEAD_TIME = 0.35  # time by which the camera looks ahead of the athletes (s)
MAX_FORCE = 900.0  # N
LINE_MASS = 46.0  # mass of camera and carriage (kg)


class CableCamera(Node):
    def __init__(self):
        super().__init__("cable_camera")
        defaults = {
            "kp": 1.6,
            "ki": 0.5,
            "kd": 1.9,
            "i_limit": 0.35,
            "max_accel": 8.0,
            "speed_filter": 0.3,
            "rate": 20.0,
            "battery_low": 44.0,
        }
        for name, value in defaults.items():
            self.declare_parameter(name, value)
        self.pid = PID(
            self.value("kp"),
            self.value("ki"),
            self.value("kd"),
            self.value("i_limit"),
            self.value("max_accel"),
        )
        self.dt = 1.0 / self.value("rate")
        self.athlete = None
        self.athlete_speed = 0.0
        self.place = None
        self.force_pub = self.create_publisher(Float64, "winch/force", 10)
        self.debug_pub = self.create_publisher(Float64MultiArray, "winch/debug", 10)
        self.create_subscription(PointStamped, "athlete", self.athlete_cb, 10)
        self.create_subscription(Odometry, "carriage", self.carriage_cb, 10)
        self.create_subscription(Float64, "battery", self.battery_cb, 10)
        self.create_timer(self.dt, self.loop)

    def value(self, name):
        param = self.get_parameter(name)
        assert param.type_ == Parameter.Type.DOUBLE
        return param.value

    def athlete_cb(self, msg):
        stamp = msg.header.stamp.sec + 1e-9 * msg.header.stamp.nanosec
        if self.athlete is not None:
            dt = stamp - self.athlete[1]
            if dt > 0.0:
                speed = (msg.point.x - self.athlete[0]) / dt
                self.athlete_speed += self.value("speed_filter") * (speed - self.athlete_speed)
        self.athlete = (msg.point.x, stamp)

    def carriage_cb(self, msg):
        self.place = msg.pose.pose.position.x

    def battery_cb(self, msg):
        if msg.data < self.value("battery_low"):
            self.get_logger().warning("battery at %.1f V" % msg.data)

    def loop(self):
        if self.athlete is None or self.place is None:
            return
        goal = self.athlete[0] + LEAD_TIME * self.athlete_speed
        goal = min(max(goal, TRACK[0]), TRACK[1])
        error = goal - self.place
        accel = self.pid(error, self.dt)
        force = min(max(LINE_MASS * accel, -MAX_FORCE), MAX_FORCE)
        self.force_pub.publish(Float64(data=force))
        self.debug_pub.publish(Float64MultiArray(data=[error, self.pid.integral, force]))


def main():
    rclpy.init()
    rclpy.spin(CableCamera())


if __name__ == "__main__":
    main()
