#!/usr/bin/env python3
"""Fly up along the pier of a bridge and take pictures of its concrete from a set distance."""

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import Imu, Range
from std_msgs.msg import Empty, Float32

STANDOFF = 1.8  # m
TOP = 14.0  # m
CLIMB = 0.5  # m/s
GAIN = 0.8  # speed per distance (1/s)
DAMPING = 0.5
TILT_COMFORT = 0.12  # tilt above which the climb waits (rad)
MAX_SPEED = 1.0  # m/s
SHARP = 0.3  # approach speed at which pictures blur (m/s)
EVERY = 0.8  # distance between pictures (m)
DT = 0.2


class PierDrone(Node):
    def __init__(self):
        super().__init__("pier_drone")
        self.distance, self.closing = None, 0.0
        self.height = 0.0
        self.pitch = 0.0
        self.last_picture = -EVERY
        self.cmd = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self.shutter = self.create_publisher(Empty, "camera/shutter", 10)
        self.create_subscription(Range, "front/range", self.on_range, 10)
        self.create_subscription(Float32, "altimeter", self.on_height, 10)
        self.create_subscription(Imu, "imu", self.on_imu, 10)
        self.create_timer(DT, self.control)

    def on_range(self, msg):
        if msg.range > 12.0:
            return
        if self.distance is not None:
            self.closing += 0.5 * ((self.distance - msg.range) / DT - self.closing)
        self.distance = msg.range

    def on_height(self, msg):
        self.height = msg.data

    def on_imu(self, msg):
        self.pitch = 2.0 * msg.orientation.y

    def forward(self):
        """Return the speed towards the pier."""
        wanted = GAIN * (self.distance - STANDOFF) - DAMPING * self.closing
        return max(-MAX_SPEED, min(MAX_SPEED, wanted))

    def climb(self):
        """Return the speed of the climb, less when the drone leans against the wind."""
        if self.height > TOP:
            return 0.0
        return CLIMB if abs(self.pitch) < TILT_COMFORT else 0.5 * CLIMB

    def picture(self):
        if self.height - self.last_picture >= EVERY and abs(self.closing) < SHARP:
            self.last_picture = self.height
            self.shutter.publish(Empty())

    def control(self):
        if self.distance is None:
            return
        msg = TwistStamped()
        msg.header.stamp = self.get_clock().now().to_msg()
        msg.twist.linear.x = self.forward()
        msg.twist.linear.z = self.climb()
        self.cmd.publish(msg)
        self.picture()


def main():
    rclpy.init()
    rclpy.spin(PierDrone())


if __name__ == "__main__":
    main()
