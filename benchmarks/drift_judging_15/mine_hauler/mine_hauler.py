#!/usr/bin/env python3
"""Backs a haul truck up to the berm of a dump and stops there."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import FluidPressure, Range
from std_msgs.msg import Float32, String

GAINS = {"speed": {"kp": 2.4, "ki": 0.2, "limit": 0.6}}
STOP_GAP = 0.8  # distance between tyres and berm (m)
CREEP = 0.25  # m/s


class SpeedLoop:
    """PI loop with a limited integral."""

    def __init__(self, kp, ki, limit):
        self.kp, self.ki, self.limit = kp, ki, limit
        self.integral = 0.0

    def reset(self):
        self.integral = 0.0

    def update(self, error, dt):
        self.integral = max(-self.limit, min(self.limit, self.integral + error * dt))
        return self.kp * error + self.ki * self.integral


class MineHauler(Node):
    def __init__(self):
        super().__init__("mine_hauler")
        self.declare_parameters(
            "",
            [
                ("max_speed", 3.5),
                ("approach_decel", 0.9),
                ("brake_max", 1.0),
                ("throttle_max", 0.5),
                ("range_timeout", 0.6),
                ("overload_pressure", 12.0e6),
                ("period", 0.1),
            ],
        )
        self.loop = SpeedLoop(**GAINS["speed"])
        self.distance = None
        self.seen = self.get_clock().now()
        self.speed = 0.0
        self.strut_pressure = 0.0
        self.state = "BACKING"
        self.pub = self.create_publisher(Twist, "drive", 10)
        self.state_pub = self.create_publisher(String, "hauler/state", 10)
        self.create_subscription(Range, "berm", self.range_cb, qos_profile_sensor_data)
        self.create_subscription(Float32, "wheel_speed", self.speed_cb, qos_profile_sensor_data)
        self.create_subscription(FluidPressure, "struts", self.strut_cb, 10)
        self.dt = self.get_parameter("period").value
        self.create_timer(self.dt, self.control)

    def range_cb(self, msg):
        if not msg.min_range <= msg.range <= msg.max_range:
            return
        if self.distance is None:
            self.distance = msg.range
        self.distance += 0.6 * (msg.range - self.distance)
        self.seen = self.get_clock().now()

    def speed_cb(self, msg):
        self.speed = msg.data

    def strut_cb(self, msg):
        self.strut_pressure = msg.fluid_pressure
        if self.strut_pressure > self.get_parameter("overload_pressure").value:
            self.get_logger().error("overload", throttle_duration_sec=5.0)

    def allowed(self):
        """Speed from which the truck still stops in front of the berm."""
        left = self.distance - STOP_GAP
        if left <= 0.0:
            return 0.0
        decel = self.get_parameter("approach_decel").value
        return max(CREEP, min(self.get_parameter("max_speed").value, math.sqrt(2.0 * decel * left)))

    def drive(self, effort):
        cmd = Twist()
        if effort >= 0.0:
            cmd.linear.x = min(effort, self.get_parameter("throttle_max").value)
        else:
            cmd.linear.y = min(-effort, self.get_parameter("brake_max").value)
        self.pub.publish(cmd)

    def control(self):
        stale = (self.get_clock().now() - self.seen).nanoseconds > self.get_parameter(
            "range_timeout"
        ).value * 1e9
        if self.distance is None or stale:
            self.drive(-0.5)
            return
        if self.state == "BACKING" and self.distance < STOP_GAP + 0.1 and self.speed < 0.3:
            self.state = "STOPPED"
            self.loop.reset()
        self.state_pub.publish(String(data=self.state))
        if self.state == "STOPPED":
            self.drive(-0.7)
            return
        self.drive(self.loop.update(self.allowed() - self.speed, self.dt))


def main(args=None):
    rclpy.init(args=args)
    node = MineHauler()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
