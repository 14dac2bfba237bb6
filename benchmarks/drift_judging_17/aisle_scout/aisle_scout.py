#!/usr/bin/env python3
"""Drives down an aisle, stops at the shelves and scans their labels."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float32, Int32


class AisleScout(Node):
    def __init__(self):
        super().__init__("aisle_scout")
        self.declare_parameter("ticks_per_metre", 18430.0)
        self.declare_parameter("cruise", 0.7)
        self.declare_parameter("creep", 0.08)
        self.declare_parameter("slow_down", 0.9)
        self.declare_parameter("heavy", 60.0)
        self.declare_parameter("heavy_cruise", 0.5)
        self.declare_parameter("stay", 2.0)
        self.declare_parameter("stops", [3.6, 7.2, 10.8])
        self.ticks_per_metre = self.get_parameter("ticks_per_metre").value
        self.slow_down = self.get_parameter("slow_down").value
        self.stay = self.get_parameter("stay").value
        self.stops = list(self.get_parameter("stops").value)
        self.first = None
        self.travelled = 0.0
        self.cruise = self.get_parameter("cruise").value
        self.waiting = 0.0
        self.speed = 0.0
        self.drive = self.create_publisher(Twist, "cmd_vel", 10)
        self.scan = self.create_publisher(Bool, "scanner/trigger", 10)
        self.create_subscription(Int32, "wheel/ticks", self.ticks_cb, 10)
        self.create_subscription(Float32, "tray/load", self.load_cb, 10)
        self.timer = self.create_timer(0.1, self.loop)

    def ticks_cb(self, msg):
        if self.first is None:
            self.first = msg.data
        self.travelled = (msg.data - self.first) / self.ticks_per_metre

    def load_cb(self, msg):
        heavy = msg.data > self.get_parameter("heavy").value
        self.cruise = self.get_parameter("heavy_cruise" if heavy else "cruise").value

    def loop(self):
        cmd = Twist()
        scanning = False
        if self.waiting > 0.0:
            self.waiting -= 0.1
            scanning = self.waiting < self.stay - 0.5
            if self.waiting <= 0.0:
                self.stops.pop(0)
        elif self.stops:
            left = self.stops[0] - self.travelled
            if left < 0.01:
                self.waiting = self.stay
            else:
                wish = self.cruise * min(1.0, left / self.slow_down)
                wish = max(wish, self.get_parameter("creep").value)
                self.speed += max(-0.08, min(0.05, wish - self.speed))
                cmd.linear.x = self.speed
        self.drive.publish(cmd)
        self.scan.publish(Bool(data=scanning))


def main(args=None):
    rclpy.init(args=args)
    node = AisleScout()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
