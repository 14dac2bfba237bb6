#!/usr/bin/env python3
"""Roll stabiliser of a small ferry: move the fins against the roll."""

import rclpy
from geometry_msgs.msg import Vector3Stamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float32


class FinStabiliser(Node):
    def __init__(self):
        super().__init__("fin_stabiliser")
        self.gain = self.declare_parameter("gain", 0.9).value  # fin angle (rad) per roll rate (rad/s)
        self.stiff = self.declare_parameter("stiff", 0.15).value  # fin angle per roll angle
        self.limit = self.declare_parameter("limit", 0.45).value
        self.bias = 0.0
        self.roll, self.rate = None, 0.0
        self.speed = 0.0
        self.fins = self.create_publisher(Float32, "fins/angle", 10)
        self.create_subscription(Vector3Stamped, "imu/roll", self.on_roll, 10)
        self.create_subscription(Odometry, "gps/odom", self.on_odom, 10)
        self.create_timer(0.2, self.control)

    def on_odom(self, msg):
        self.speed = msg.twist.twist.linear.x
        if self.speed < 1.0:
            self.get_logger().warn("too slow for the fins", once=True)

    def on_roll(self, msg):
        self.roll = msg.vector.x
        self.rate = 0.3 * self.rate + 0.7 * msg.vector.y

    def control(self):
        if self.roll is None:
            return
        self.bias = 0.98 * self.bias + 0.02 * self.roll
        fin = -self.gain * self.rate - self.stiff * (self.roll - self.bias)
        if fin > self.limit:
            fin = self.limit
        elif fin < -self.limit:
            fin = -self.limit
        self.fins.publish(Float32(data=fin))


def main():
    rclpy.init()
    rclpy.spin(FinStabiliser())


if __name__ == "__main__":
    main()
