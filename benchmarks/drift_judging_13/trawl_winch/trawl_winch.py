#!/usr/bin/env python3
"""Keep a pelagic trawl in the layer of fish: pay out or haul the warps of the net.

The echo sounder gives the depth of the layer, and a counter on the block the length of warp that is out. The length for
a depth follows from the ratio of warp to depth, which the skipper knows for the usual towing speed.
"""

import rclpy
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from rclpy.node import Node
from std_msgs.msg import Float32


class Smoothed:
    """A mean that forgets."""

    def __init__(self, share):
        self.share = share
        self.value = None

    def add(self, value):
        if self.value is None:
            self.value = value
        self.value += self.share * (value - self.value)
        return self.value


class TrawlWinch(Node):
    def __init__(self):
        super().__init__("trawl_winch")
        self.declare_parameters(
            "",
            [
                ("warp_ratio", 2.5),  # length of warp per metre of depth
                ("headline", 4.0),  # height of the net's set point above the middle of the layer (m)
                ("gain", 0.08),  # speed per metre of warp (1/s)
                ("deadband", 2.0),  # m
                ("max_speed", 1.4),  # m/s
                ("max_tension", 60.0),  # tension above which the winch gives way (kN)
                ("period", 2.0),
            ],
        )
        self.ratio = self.get_parameter("warp_ratio").value
        self.headline = self.get_parameter("headline").value
        self.gain = self.get_parameter("gain").value
        self.deadband = self.get_parameter("deadband").value
        self.max_speed = self.get_parameter("max_speed").value
        self.max_tension = self.get_parameter("max_tension").value

        self.layer = Smoothed(0.15)
        self.out = None
        self.through_water = 0.0
        self.tension = 0.0
        self.winch = self.create_publisher(Float32, "winch/speed", 10)
        self.status = self.create_publisher(DiagnosticStatus, "winch/status", 10)
        self.create_subscription(Float32, "sounder/layer", self.layer_callback, 10)
        self.create_subscription(Float32, "block/length", self.length_callback, 10)
        self.create_subscription(Float32, "block/tension", self.tension_callback, 10)
        self.create_subscription(Float32, "log/speed", self.log_callback, 10)
        self.timer = self.create_timer(self.get_parameter("period").value, self.tick)
        self.ticks = 0

    def layer_callback(self, msg):
        if msg.data > 10.0:  # the sounder returns 0 if there is no echo
            self.layer.add(msg.data)

    def length_callback(self, msg):
        self.out = msg.data

    def tension_callback(self, msg):
        self.tension = msg.data

    def log_callback(self, msg):
        self.through_water = msg.data

    def wanted_length(self):
        depth = self.layer.value - self.headline
        return depth * self.ratio

    def speed(self):
        if self.tension > self.max_tension:
            self.get_logger().warn("tension: warp is given", throttle_duration_sec=30.0)
            return 0.5 * self.max_speed
        error = self.wanted_length() - self.out
        if abs(error) < self.deadband:
            return 0.0
        return max(-self.max_speed, min(self.max_speed, self.gain * error))

    def report(self):
        msg = DiagnosticStatus(name="trawl_winch", message="fishing", level=DiagnosticStatus.OK)
        msg.values = [
            KeyValue(key="warp", value=f"{self.out:.0f} m"),
            KeyValue(key="log", value=f"{self.through_water / 0.5144:.1f} kn"),
        ]
        self.status.publish(msg)

    def tick(self):
        if self.layer.value is None or self.out is None:
            return
        self.winch.publish(Float32(data=self.speed()))
        self.ticks += 1
        if self.ticks % 30 == 0:
            self.report()


def main():
    rclpy.init()
    node = TrawlWinch()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
