#!/usr/bin/env python3
"""Plough that clears the lanes of a helipad by night, on the encoders of its tracks."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float32

METRES_PER_TICK = 0.002
TRACK = 0.95  # distance between the tracks (m)
LANES = [(7.0, 0.0), (7.0, 5.0), (0.5, 5.0), (0.5, 10.0), (7.0, 10.0)]  # m
SPEED = 0.7  # m/s
TURN = 1.4  # 1/s
MAX_TURN = 0.6  # rad/s
REACHED = 0.25  # m
ON_COURSE = 0.25  # rad
BLADE_OVER = 0.02  # depth of snow below which the blade stays up (m)


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


class HelipadPlough(Node):
    def __init__(self):
        super().__init__("helipad_plough")
        self.x, self.y, self.yaw = 0.0, 0.0, 0.0
        self.ticks = None
        self.snow = 0.0
        self.lane = 0
        self.cmd = self.create_publisher(Twist, "cmd_vel", 10)
        self.blade = self.create_publisher(Float32, "blade/height", 10)
        self.create_subscription(JointState, "tracks", self.on_tracks, 10)
        self.create_subscription(Float32, "snow/depth", self.on_snow, 10)
        self.create_timer(0.2, self.drive)

    def on_tracks(self, msg):
        left, right = msg.position
        if self.ticks is not None:
            self.move(left - self.ticks[0], right - self.ticks[1])
        self.ticks = (left, right)

    def move(self, left, right):
        """Follow the tracks by their ticks since the last message."""
        travelled = METRES_PER_TICK * (left + right) / 2
        turned = METRES_PER_TICK * (right - left) / TRACK
        self.x += travelled * math.cos(self.yaw + turned / 2)
        self.y += travelled * math.sin(self.yaw + turned / 2)
        self.yaw = wrapped(self.yaw + turned)

    def on_snow(self, msg):
        self.snow += 0.2 * (msg.data - self.snow)

    def blade_height(self):
        return 0.005 if self.snow > BLADE_OVER else 0.15

    def steer(self, twist):
        gx, gy = LANES[self.lane]
        if math.hypot(gx - self.x, gy - self.y) < REACHED:
            self.lane += 1
            self.get_logger().info("lane %d is done" % self.lane)
            return
        error = wrapped(math.atan2(gy - self.y, gx - self.x) - self.yaw)
        twist.angular.z = max(-MAX_TURN, min(MAX_TURN, TURN * error))
        if abs(error) < ON_COURSE:
            twist.linear.x = SPEED

    def drive(self):
        twist = Twist()
        if self.ticks is not None and self.lane < len(LANES):
            self.steer(twist)
        self.cmd.publish(twist)
        self.blade.publish(Float32(data=self.blade_height()))


def main():
    rclpy.init()
    rclpy.spin(HelipadPlough())


if __name__ == "__main__":
    main()
