#!/usr/bin/env python3
"""Measure the radius of a roll of film by an ultrasonic sensor that looks at it from the side."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Float32

MOUNT = 0.60  # distance from the sensor to the axle (m)
CORE, FULL = 0.05, 0.42  # m
SMOOTHING = 0.2


class RollGauge(Node):
    def __init__(self):
        super().__init__("roll_gauge")
        self.radius = None
        self.pub = self.create_publisher(Float32, "roll/radius", 10)
        self.create_subscription(Range, "roll/range", self.on_range, 10)

    def on_range(self, msg):
        radius = MOUNT - msg.range
        if not CORE < radius < FULL:
            return
        if self.radius is None:
            self.radius = radius
        self.radius += SMOOTHING * (radius - self.radius)
        self.pub.publish(Float32(data=self.radius))


def main():
    rclpy.init()
    rclpy.spin(RollGauge())


if __name__ == "__main__":
    main()
