#!/usr/bin/env python3
"""Steers the shield of a pipe jacking rig along the beam of a laser that shines through the pipes from the shaft.

Offsets are in mm to the right of the beam, headings and steering angles in mrad to the right.
"""

from collections import deque

import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, Float32, String


def limited(value, largest):
    return max(-largest, min(largest, value))


class PipeJacker(Node):
    KP = 0.2  # mrad per mm
    DEAD_BAND = 1.0  # mm
    MAX_STEER = 12.0  # mrad, stroke of the steering cylinders
    STEER_RATE = 1.5  # mrad per cycle
    CYCLE = 3.0  # s
    BEAM_LOST = 10.0  # s
    CROOKED = 30.0  # mrad; more opens the joint behind the shield

    def __init__(self):
        super().__init__("pipe_jacker")
        self.thrust_limit = self.declare_parameter("thrust_limit", 900.0).value  # kN
        self.jack_speed = self.declare_parameter("jack_speed", 0.05).value  # m/s
        window = self.declare_parameter("target_average", 2).value
        self.hits = deque(maxlen=window)  # of the laser on the target, which dust and steam blur
        self.last_hit = None
        self.heading = 0.0
        self.thrust = 0.0
        self.steer = 0.0
        self.enabled = False
        self.steer_pub = self.create_publisher(Float32, "shield/steer", 1)
        self.jack_pub = self.create_publisher(Float32, "jacks/speed", 1)
        self.status_pub = self.create_publisher(String, "shield/status", 1)
        self.create_subscription(PointStamped, "shield/target", self.on_target, 5)
        self.create_subscription(Imu, "shield/gyro", self.on_gyro, 5)
        self.create_subscription(Float32, "jacks/thrust", self.on_thrust, 5)
        self.create_subscription(Bool, "shaft/release", self.on_release, 1)
        self.create_timer(self.CYCLE, self.cycle)

    def on_target(self, msg):
        self.hits.append(1000.0 * msg.point.x)
        self.last_hit = self.get_clock().now()

    def on_gyro(self, msg):
        # the north-seeking gyro is set to the axis of the drive; small angles
        self.heading = 2000.0 * msg.orientation.z

    def on_thrust(self, msg):
        self.thrust = msg.data

    def on_release(self, msg):
        if msg.data != self.enabled:
            self.get_logger().info("jacks released" if msg.data else "jacks locked")
        self.enabled = msg.data

    def sees_beam(self):
        if self.last_hit is None:
            return False
        return (self.get_clock().now() - self.last_hit).nanoseconds < self.BEAM_LOST * 1e9

    def offset(self):
        return sum(self.hits) / len(self.hits)

    def wanted_steer(self):
        off = self.offset()
        if abs(off) < self.DEAD_BAND:
            return 0.0
        return limited(-self.KP * off, self.MAX_STEER)

    def stop(self, why):
        self.jack_pub.publish(Float32(data=0.0))
        self.status_pub.publish(String(data=why))

    def cycle(self):
        if not self.enabled:
            self.stop("locked")
            return
        if not self.sees_beam():
            self.stop("no beam")
            return
        if self.thrust > self.thrust_limit:
            self.stop("thrust")
            return
        self.steer += limited(self.wanted_steer() - self.steer, self.STEER_RATE)
        self.steer_pub.publish(Float32(data=self.steer))
        self.jack_pub.publish(Float32(data=self.jack_speed))
        if abs(self.heading) > self.CROOKED:
            self.get_logger().warning(f"shield is {self.heading:.0f} mrad off the axis")
            self.status_pub.publish(String(data="crooked"))
        else:
            self.status_pub.publish(String(data="jacking"))


def main():
    rclpy.init()
    rclpy.spin(PipeJacker())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
