#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32


class Spreader(Node):
    """Open the salt gate further the colder the road is."""

    def __init__(self):
        super().__init__("spreader")
        self.base = self.declare_parameter("base", 0.16).value
        self.per_degree = self.declare_parameter("per_degree", 0.02).value
        self.most = self.declare_parameter("most", 1.0).value
        self.road = 0.0
        self.gate = self.create_publisher(Float32, "~/gate", 10)
        self.create_subscription(Float32, "road/temperature", self.temperature_cb, 10)
        self.create_timer(0.5, self.timer_cb)

    def temperature_cb(self, msg):
        self.road += 0.6 * (msg.data - self.road)

    def opening(self):
        frost = max(0.0, -self.road)
        return self.base + self.per_degree * frost

    def timer_cb(self):
        msg = Float32()
        msg.data = min(self.most, self.opening())
        self.gate.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    spreader = Spreader()
    rclpy.spin(spreader)
    spreader.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
