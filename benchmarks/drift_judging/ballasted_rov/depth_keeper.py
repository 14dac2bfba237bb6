#!/usr/bin/env python3
"""Hold an underwater robot at the depth that the operator asks for."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

MOST_THRUST = 1.0


def clipped(value, most):
    """Limit a value to a range symmetric about 0."""
    return max(-most, min(most, value))


class DepthKeeper(Node):
    """Compute depth from pressure and thrust from depth; positive is down."""

    def __init__(self):
        super().__init__("depth_keeper")
        gains = self.declare_parameters("", [("kp", 0.12), ("kd", 0.45), ("period", 0.2), ("smoothing", 0.5)])
        self.kp, self.kd, self.period, self.smoothing = (gain.value for gain in gains)
        self.wanted = None
        self.depth = None
        self.sinking = 0.0
        self.create_subscription(Float64, "/wanted_depth", self.on_wanted, 10)
        self.create_subscription(Float64, "/pressure", self.on_pressure, 10)
        self.thrust = self.create_publisher(Float64, "/thrust", 10)
        self.create_timer(self.period, self.on_timer)

    def on_wanted(self, msg):
        """Store the depth to hold, m."""
        self.wanted = msg.data

    def on_pressure(self, msg):
        """Store the pressure above that at the surface, kPa. Sea water adds 10.1 kPa per metre."""
        depth = msg.data / 10.1
        if self.depth is not None:
            rate = (depth - self.depth) / self.period
            self.sinking += self.smoothing * (rate - self.sinking)
        self.depth = depth

    def on_timer(self):
        """Send one command."""
        if self.wanted is None or self.depth is None:
            return
        error = self.wanted - self.depth
        thrust = self.kp * error - self.kd * self.sinking
        self.thrust.publish(Float64(data=clipped(thrust, MOST_THRUST)))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(DepthKeeper())


if __name__ == "__main__":
    main()
