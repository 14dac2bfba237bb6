"""Tests whether all messages have arrived, in other ways than `is None` for each message."""

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool


class Starter(Node):
    def __init__(self):
        super().__init__("starter")
        self.odom = None
        self.scan = None
        self.stuck = False
        self.levels = []
        self.pub = self.create_publisher(Bool, "ready", 1)
        self.create_subscription(Odometry, "odom", self.on_odom, 1)  # source odom
        self.create_subscription(LaserScan, "scan", self.on_scan, 1)  # source scan
        self.create_timer(0.1, self.tick)

    def on_odom(self, msg):
        self.odom = msg
        self.stuck = msg.twist.twist.linear.x

    def on_scan(self, msg):
        self.scan = msg
        self.levels = [r < 0.3 for r in msg.ranges]

    def tick(self):
        if None in (self.odom, self.scan):
            self.pub.publish(Bool(data=False))  # clean
        if not all([self.odom, self.scan]):
            self.pub.publish(Bool(data=False))  # clean
        if any((self.odom, self.scan)):
            self.pub.publish(Bool(data=True))  # clean
        ready = [self.odom, self.scan]
        if all(ready):
            self.pub.publish(Bool(data=True))  # clean
        self.pub.publish(Bool(data=bool(self.odom and self.scan)))  # clean
        self.pub.publish(Bool(data=None not in ready))  # clean
        self.pub.publish(Bool(data=bool(self.stuck)))  # sink odom
        self.pub.publish(Bool(data=any([self.stuck, False])))  # sink odom
        self.pub.publish(Bool(data=any(self.levels)))  # sink scan
        if all(r > 0.3 for r in self.scan.ranges):
            self.pub.publish(Bool(data=True))  # sink ~scan


rclpy.init()
rclpy.spin(Starter())
