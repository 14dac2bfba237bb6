#!/usr/bin/env python3
"""Baggage tug that pulls its dollies along the apron to a belt loader, and stops in front of it."""

import rclpy
from approach import Approach
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, String, UInt8


class LuggageTug(Node):
    def __init__(self):
        super().__init__("luggage_tug")
        self.declare_parameter("cruise", 3.4)
        self.approach = Approach(cruise=self.get_parameter("cruise").value)
        self.gap = None
        self.people = False
        self.dollies = 0
        self.parked = False
        self.cmd = self.create_publisher(Twist, "cmd_vel", 5)
        self.state = self.create_publisher(String, "tug/state", 5)
        self.create_subscription(Range, "loader/range", self.range_cb, 5)
        self.create_subscription(Bool, "lidar/person", self.person_cb, 5)
        self.create_subscription(UInt8, "train/dollies", self.dollies_cb, 5)
        self.timer = self.create_timer(0.1, self.drive)

    def range_cb(self, msg):
        self.gap = msg.range

    def person_cb(self, msg):
        self.people = msg.data

    def dollies_cb(self, msg):
        if msg.data != self.dollies:
            self.get_logger().info(f"pulling {msg.data} dollies")
        self.dollies = msg.data

    def drive(self):
        if self.gap is None:
            return
        if self.approach.arrived(self.gap):
            self.parked = True
        twist = Twist()
        if not self.parked and not self.people:
            twist.linear.x = self.approach.speed(self.gap)
        self.cmd.publish(twist)
        self.state.publish(String(data="parked" if self.parked else "approach"))


def main(args=None):
    rclpy.init(args=args)
    tug = LuggageTug()
    try:
        rclpy.spin(tug)
    except KeyboardInterrupt:
        pass
    tug.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
