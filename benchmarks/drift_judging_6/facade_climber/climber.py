#!/usr/bin/env python3
"""Climb a facade: a fan sucks the chassis to the wall, and the wheels drive while the chassis grips."""

from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure
from std_msgs.msg import Float32


@dataclass
class Settings:
    target: float
    grip: float
    base: float
    gain: float
    fan_max: float
    speed: float


class FacadeClimber(Node):
    def __init__(self):
        super().__init__("facade_climber")
        self.settings = self.load()
        self.pressure = None
        self.goal = None
        self.height = 0.0
        self.fan_pub = self.create_publisher(Float32, "fan", 10)
        self.cmd_pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(FluidPressure, "chamber", self.on_chamber, 10)
        self.create_subscription(Float32, "height", self.on_height, 10)
        self.create_subscription(Float32, "goal", self.on_goal, 10)
        self.create_timer(0.1, self.tick)

    def load(self):
        names = ("target_pressure", "grip_pressure", "fan_base", "fan_gain", "fan_max", "climb_speed")
        for name in names:
            self.declare_parameter(name, 0.0)
        return Settings(*[self.get_parameter(name).value for name in names])

    def on_chamber(self, msg):
        raw = msg.fluid_pressure / 1000.0
        if self.pressure is None:
            self.pressure = raw
        self.pressure += 0.5 * (raw - self.pressure)

    def on_height(self, msg):
        self.height = msg.data

    def on_goal(self, msg):
        self.goal = msg.data

    def fan(self):
        s = self.settings
        wanted = s.base + s.gain * (s.target - self.pressure)
        return min(max(wanted, 0.0), s.fan_max)

    def climb(self):
        s = self.settings
        if self.goal is None or self.pressure < s.grip:
            return 0.0
        ahead = self.goal - self.height
        if ahead < 0.02:
            return 0.0
        return min(s.speed, 0.05 + 0.8 * ahead)

    def tick(self):
        if self.pressure is None:
            return
        self.fan_pub.publish(Float32(data=self.fan()))
        twist = Twist()
        twist.linear.x = self.climb()
        self.cmd_pub.publish(twist)


def main():
    rclpy.init()
    node = FacadeClimber()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
