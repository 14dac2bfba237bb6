import numpy as np
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64


class Masks(Node):
    def __init__(self):
        super().__init__("masks")
        self.out = self.create_publisher(Float64, "out", 10)
        self.create_subscription(LaserScan, "scan", self.heard, 10)  # source scan

    def heard(self, msg):
        beams = np.array(msg.ranges)
        blank = np.zeros_like(beams)
        self.out.publish(Float64(data=float(blank[0])))  # clean
        level = np.full_like(beams, msg.range_max)
        self.out.publish(Float64(data=float(level[0])))  # sink scan
        mask = np.ones_like(beams, dtype=float)
        mask[beams > 1.0] = 0.0
        self.out.publish(Float64(data=float(mask.sum())))  # sink scan
        self.out.publish(Float64(data=float(np.empty_like(prototype=beams)[1])))  # sink scan


rclpy.init()
rclpy.spin(Masks())
