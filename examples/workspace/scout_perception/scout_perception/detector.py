"""Publish the nearest obstacle that the laser scanner sees."""

import math

import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class Detector(Node):
    """Turns each scan into the point of its shortest range."""

    def __init__(self):
        super().__init__("detector")
        self.declare_parameter("farthest", 5.0)
        self.farthest = self.get_parameter("farthest").value
        self.obstacles = self.create_publisher(PointStamped, "obstacles", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        """Publish the nearest point within reach."""
        nearest = min(range(len(scan.ranges)), key=lambda index: scan.ranges[index])
        distance = scan.ranges[nearest]
        if distance > self.farthest:
            return
        angle = scan.angle_min + nearest * scan.angle_increment
        point = PointStamped(header=scan.header)
        point.point.x = distance * math.cos(angle)
        point.point.y = distance * math.sin(angle)
        self.obstacles.publish(point)


def main():
    """Start the node."""
    rclpy.init()
    rclpy.spin(Detector())
