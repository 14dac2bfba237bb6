#!/usr/bin/env python3
"""Boom of a hedge trimmer on a tractor: keeps the cutter bar at a clearance from the stems while the tractor drives."""

import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, Float32


def clamp(x, limit):
    return max(-limit, min(limit, x))


class HedgeTrimmer(Node):
    def __init__(self):
        super().__init__("hedge_trimmer")
        self.declare_parameters(
            namespace="",
            parameters=[
                ("clearance", 0.3),
                ("gain", 1.5),
                ("max_valve", 0.8),
                ("engage", 0.55),
                ("timeout", 1.0),
            ],
        )
        self.clearance = self.get_parameter("clearance").value
        self.gain = self.get_parameter("gain").value
        self.max_valve = self.get_parameter("max_valve").value
        self.gap = None
        self.heard = self.get_clock().now()
        self.valve_pub = self.create_publisher(Float32, "boom/valve", 1)
        self.cutter_pub = self.create_publisher(Bool, "cutter/on", 1)
        self.create_subscription(Range, "bar/sonar", self.sonar_cb, qos_profile_sensor_data)
        self.create_timer(0.1, self.control)
        self.create_timer(0.5, self.cutter)

    def sonar_cb(self, msg):
        if msg.min_range <= msg.range <= msg.max_range:
            self.gap = msg.range
            self.heard = self.get_clock().now()

    def stale(self):
        age = (self.get_clock().now() - self.heard).nanoseconds * 1e-9
        return self.gap is None or age > self.get_parameter("timeout").value

    def control(self):
        """Extend the boom if the bar is too far from the hedge."""
        valve = 0.0
        if not self.stale():
            valve = clamp(self.gain * (self.gap - self.clearance), self.max_valve)
        self.valve_pub.publish(Float32(data=valve))

    def cutter(self):
        near = not self.stale() and self.gap < self.get_parameter("engage").value
        self.cutter_pub.publish(Bool(data=near))


def main():
    rclpy.init()
    node = HedgeTrimmer()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
