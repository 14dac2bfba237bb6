#!/usr/bin/env python3
"""Flies a hydrofoil boat at its ride height: reads an altimeter at the bow and moves the flaps of the front foil."""

import math

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32, Float32MultiArray, String

PERIOD = 0.05  # s


class Hydrofoil(Node):
    def __init__(self):
        super().__init__("hydrofoil")
        self.declare_parameters(
            "",
            [
                ("ride_height", 0.6),  # m
                ("kp", 9.0),  # flap per m
                ("kd", 4.0),  # flap per m/s
                ("ki", 0.8),  # flap per m and s
                ("trim_limit", 0.5),
                ("flap_limit", 3.0),
                ("take_off_ramp", 0.25),  # m/s
                ("oil_warning", 11.0),
            ],
        )
        self.kp = self.get_parameter("kp").value
        self.kd = self.get_parameter("kd").value
        self.ki = self.get_parameter("ki").value
        self.flap_limit = self.get_parameter("flap_limit").value

        self.height = None
        self.last_height = None
        self.stamp = None
        self.setpoint = None
        self.trim = 0.0
        self.airborne = False
        self.oil = 0.0
        self.lowest, self.highest = math.inf, -math.inf

        qos = QoSProfile(depth=5)
        self.flap_pub = self.create_publisher(Float32, "foil/flap", qos)
        self.terms_pub = self.create_publisher(Float32MultiArray, "foil/terms", qos)
        self.status_pub = self.create_publisher(String, "foil/status", qos)
        self.create_subscription(Range, "bow/altimeter", self.altimeter_cb, qos)
        self.create_subscription(Bool, "helm/fly", self.fly_cb, qos)
        self.create_subscription(Float32, "hydraulics/oil", self.oil_cb, qos)
        self.create_timer(PERIOD, self.fly)
        self.create_timer(2.0, self.status)

    def altimeter_cb(self, msg):
        if not msg.min_range <= msg.range <= msg.max_range:
            return
        self.height = msg.range
        self.stamp = self.get_clock().now()

    def fly_cb(self, msg):
        if msg.data and not self.airborne:
            self.get_logger().info("taking off")
            self.setpoint = self.height
            self.trim = 0.0
        self.airborne = msg.data and self.height is not None

    def oil_cb(self, msg):
        limit = self.get_parameter("oil_warning").value
        if msg.data > limit >= self.oil:
            self.get_logger().warning(f"hydraulic oil {msg.data:.1f} above ambient")
        self.oil = msg.data

    def stale(self):
        return (self.get_clock().now() - self.stamp).nanoseconds > 5e8

    def fly(self):
        flap = 0.0
        if self.airborne and self.setpoint is not None:
            if self.stale():
                self.get_logger().error("no height", throttle_duration_sec=1.0)
                self.airborne = False
            else:
                flap = self.control()
        self.flap_pub.publish(Float32(data=float(flap)))

    def control(self):
        """Return the flap for the height of this period."""
        ramp = self.get_parameter("take_off_ramp").value * PERIOD
        wanted = self.get_parameter("ride_height").value
        self.setpoint += min(ramp, max(-ramp, wanted - self.setpoint))

        height = self.height
        if self.last_height is None:
            self.last_height = height
        climb = (height - self.last_height) / PERIOD
        self.last_height = height
        self.lowest, self.highest = min(self.lowest, height), max(self.highest, height)

        error = self.setpoint - height
        limit = self.get_parameter("trim_limit").value
        self.trim = min(limit, max(-limit, self.trim + self.ki * error * PERIOD))
        terms = [self.kp * error, -self.kd * climb, self.trim]
        self.terms_pub.publish(Float32MultiArray(data=[float(term) for term in terms]))
        return min(self.flap_limit, max(-self.flap_limit, sum(terms)))

    def status(self):
        state = "flying" if self.airborne else "hull"
        self.status_pub.publish(String(data=f"{state}, height {self.lowest:.2f} to {self.highest:.2f} m"))
        self.lowest, self.highest = math.inf, -math.inf


def main(args=None):
    rclpy.init(args=args)
    node = Hydrofoil()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
