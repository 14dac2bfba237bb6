#!/usr/bin/env python3
"""Follow a swimmer with a camera on a rail beside the pool."""

import rclpy
from alpha_beta import AlphaBeta
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64

DT = 0.1


class SwimCamera(Node):
    def __init__(self):
        super().__init__("swim_camera")
        self.pool_length = self.declare_parameter("pool_length", 50.0).value
        self.latency = self.declare_parameter("latency", 0.0).value
        self.kp = self.declare_parameter("kp", 2.0).value
        self.max_speed = self.declare_parameter("max_speed", 2.0).value
        self.lost_after = self.declare_parameter("lost_after", 2.0).value
        alpha = self.declare_parameter("alpha", 0.5).value
        beta = self.declare_parameter("beta", 0.1).value

        self.filter = AlphaBeta(alpha, beta, DT)
        self.trolley = 0.0
        self.seen = self.get_clock().now()
        self.speed_pub = self.create_publisher(Float64, "trolley/speed", 1)
        self.tally_pub = self.create_publisher(Bool, "tally", 1)
        self.create_subscription(PointStamped, "swimmer", self.swimmer_cb, 10)
        self.create_subscription(JointState, "trolley/state", self.trolley_cb, 10)
        self.create_timer(DT, self.loop)

    def swimmer_cb(self, msg):
        self.filter.update(msg.point.x)
        self.seen = self.get_clock().now()

    def trolley_cb(self, msg):
        self.trolley = msg.position[0]

    def aim(self):
        """Where the swimmer is by now, but not behind a wall."""
        x = self.filter.ahead(self.latency)
        return min(max(x, 0.0), self.pool_length)

    def lost(self):
        return (self.get_clock().now() - self.seen).nanoseconds > self.lost_after * 1e9

    def loop(self):
        if self.filter.x is None:
            return
        self.tally_pub.publish(Bool(data=not self.lost()))
        if self.lost():
            self.speed_pub.publish(Float64(data=0.0))
            return
        speed = self.filter.v + self.kp * (self.aim() - self.trolley)
        speed = max(-self.max_speed, min(self.max_speed, speed))
        self.speed_pub.publish(Float64(data=speed))


def main():
    rclpy.init()
    node = SwimCamera()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
