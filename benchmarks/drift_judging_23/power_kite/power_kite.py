#!/usr/bin/env python3
"""Flies the kite of an airborne wind generator in figures of eight across the wind window.

Azimuth is 0 downwind and positive to the right as seen from the winch, elevation is above the ground; course 0 points
up to the zenith, and a positive one turns to the right. Angles are in rad.
"""

import math

import rclpy
from geometry_msgs.msg import Vector3Stamped
from rclpy.node import Node
from std_msgs.msg import Float32, String


def wrap(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def bearing(azimuth, elevation, to_azimuth, to_elevation):
    """Return the course from one point of the wind window to another."""
    return math.atan2((to_azimuth - azimuth) * math.cos(elevation), to_elevation - elevation)


class PowerKite(Node):
    PARK, EIGHT, LAND = "park", "eight", "land"
    CALM = 4.0  # m/s, in less the lines slacken
    STORM = 17.0  # m/s

    def __init__(self):
        super().__init__("power_kite")
        self.gain = self.declare_parameter("steering.gain", 1.2).value
        self.limit = self.declare_parameter("steering.limit", 1.0).value
        self.rate = self.declare_parameter("steering.rate", 6.0).value  # 1/s
        self.half_width = self.declare_parameter("eight.half_width", 0.7).value
        self.elevation = self.declare_parameter("eight.elevation", 0.6).value
        self.switch = self.declare_parameter("eight.switch", 0.36).value
        self.floor = self.declare_parameter("eight.floor", 0.3).value
        self.mode = self.PARK
        self.side = 1.0
        self.position = None
        self.wind = None
        self.delta = 0.0
        self.period = 0.1
        self.steer_pub = self.create_publisher(Float32, "kite/steer", 1)
        self.mode_pub = self.create_publisher(String, "kite/mode", 1)
        self.create_subscription(Vector3Stamped, "kite/position", self.position_cb, 5)
        self.create_subscription(Float32, "winch/wind", self.wind_cb, 1)
        self.create_subscription(String, "operator/mode", self.mode_cb, 1)
        self.create_timer(self.period, self.control)

    def position_cb(self, msg):
        # x: azimuth, y: elevation, z: course over the window
        self.position = msg.vector

    def wind_cb(self, msg):
        self.wind = msg.data if self.wind is None else 0.8 * self.wind + 0.2 * msg.data
        if not self.CALM < self.wind < self.STORM:
            self.get_logger().warning(f"wind of {self.wind:.1f} m/s, kite comes down")
            self.mode = self.LAND

    def mode_cb(self, msg):
        if self.mode != self.LAND:
            self.mode = msg.data

    def target(self):
        at = self.position
        if self.mode != self.EIGHT:
            return 0.0, math.pi / 2.0
        if self.side * at.x > self.switch:
            self.side = -self.side
        if at.y < self.floor:
            # too low: climb first, on the side where the kite is
            return at.x, math.pi / 2.0
        return self.side * self.half_width, self.elevation

    def control(self):
        if self.position is None:
            return
        at = self.position
        azimuth, elevation = self.target()
        error = wrap(bearing(at.x, at.y, azimuth, elevation) - at.z)
        wanted = max(-self.limit, min(self.limit, self.gain * error))
        step = self.rate * self.period
        self.delta += max(-step, min(step, wanted - self.delta))
        self.steer_pub.publish(Float32(data=self.delta))
        self.mode_pub.publish(String(data=self.mode))


def main(args=None):
    rclpy.init(args=args)
    kite = PowerKite()
    rclpy.spin(kite)
    kite.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
