#!/usr/bin/env python3
"""Turns an aircraft engine on its stand to the poses that an inspector asks for, and holds it there."""

import math
from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float32, String

DEFAULTS = {
    "servo.stiffness": 160.0,  # Nm/rad
    "servo.damping": 160.0,  # Nm s/rad
    "servo.torque_limit": 1600.0,  # Nm
    "servo.integral": 0.0,
    "pose.tolerance": 0.03,  # rad
    "pose.still": 0.05,  # rad/s
    "pose.hold": 0.6,  # s
    "limits.lower": -2.4,
    "limits.upper": 2.4,
    "watchdog": 0.5,  # s without a joint state
}


@dataclass
class Axis:
    position: float = 0.0
    velocity: float = 0.0
    stamp: float = -1.0


class EngineStand(Node):
    def __init__(self):
        super().__init__("engine_stand")
        self.p = {name: self.declare_parameter(name, value).value for name, value in DEFAULTS.items()}
        self.axis = Axis()
        self.target = None
        self.windup = 0.0
        self.good_since = None
        self.announced = False
        self.load = []
        self.enabled = False
        self.torque_pub = self.create_publisher(Float32, "stand/torque", 1)
        self.reached_pub = self.create_publisher(Bool, "stand/reached", 1)
        self.status_pub = self.create_publisher(String, "stand/status", 1)
        self.create_subscription(JointState, "stand/joint", self.on_joint, 10)
        self.create_subscription(Float32, "inspector/pose", self.on_pose, 5)
        self.create_subscription(Float32, "stand/load", self.on_load, 5)
        self.create_subscription(Bool, "stand/enable", self.on_enable, 1)
        self.create_timer(0.1, self.servo)
        self.create_timer(5.0, self.status)

    def clock_seconds(self):
        return self.get_clock().now().nanoseconds * 1e-9

    def on_enable(self, msg):
        self.enabled = msg.data

    def on_joint(self, msg):
        if not msg.position or not msg.velocity:
            return
        self.axis = Axis(msg.position[0], msg.velocity[0], self.clock_seconds())

    def on_load(self, msg):
        self.load = (self.load + [msg.data])[-10:]

    def on_pose(self, msg):
        target = min(self.p["limits.upper"], max(self.p["limits.lower"], msg.data))
        if target != msg.data:
            self.get_logger().warning(f"pose {msg.data:.2f} is out of range")
        self.target = target
        self.windup = 0.0
        self.good_since = None
        self.announced = False

    def torque(self, error):
        """Return the torque of the servo in Nm."""
        stiffness = self.p["servo.stiffness"]
        damping = self.p["servo.damping"]
        self.windup += self.p["servo.integral"] * error * 0.1
        torque = stiffness * error - damping * self.axis.velocity + self.windup
        limit = self.p["servo.torque_limit"]
        if abs(torque) > limit:
            torque = math.copysign(limit, torque)
        return torque

    def watch(self, error):
        """Tell the inspector once the engine has stood still at its pose for a while."""
        now = self.clock_seconds()
        good = abs(error) < self.p["pose.tolerance"] and abs(self.axis.velocity) < self.p["pose.still"]
        if not good:
            self.good_since = None
        elif self.good_since is None:
            self.good_since = now
        elif now - self.good_since >= self.p["pose.hold"] and not self.announced:
            self.announced = True
            self.reached_pub.publish(Bool(data=True))

    def servo(self):
        torque = 0.0
        if self.enabled and self.target is not None:
            if self.clock_seconds() - self.axis.stamp > self.p["watchdog"]:
                self.get_logger().error("no joint state", throttle_duration_sec=2.0)
            else:
                error = self.target - self.axis.position
                torque = self.torque(error)
                self.watch(error)
        self.torque_pub.publish(Float32(data=float(torque)))

    def status(self):
        load = sum(self.load) / len(self.load) if self.load else math.nan
        text = f"at {self.axis.position:+.2f} rad, {load:.0f} kg on the stand"
        self.status_pub.publish(String(data=text))


def main(args=None):
    rclpy.init(args=args)
    node = EngineStand()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
