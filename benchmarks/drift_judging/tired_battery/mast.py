#!/usr/bin/env python3
"""Raise a camera mast to the requested height and hold it there against its weight."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32

GAINS = {"hold": 0.45, "pull": 0.3, "damp": 0.35}  # duty, duty per m, duty per m/s
MOST_DUTY = 1.0


class Mast(Node):
    """A feed-forward for the weight, a spring and a damper."""

    def __init__(self):
        super().__init__("mast")
        self.height = None
        self.rising = 0.0
        self.goal = 0.0
        self.period = 0.1
        self.create_subscription(Float32, "/height", self.on_height, 10)
        self.create_subscription(Float32, "/goal", self.on_goal, 10)
        self.winch = self.create_publisher(Float32, "/winch", 10)
        self.create_timer(self.period, self.on_timer)

    def on_height(self, msg):
        """Store the height of the camera, m."""
        if self.height is not None:
            self.rising = 0.6 * self.rising + 0.4 * (msg.data - self.height) / self.period
        self.height = msg.data

    def on_goal(self, msg):
        """Store the requested height of the camera, m."""
        self.goal = msg.data

    def duty(self):
        """Return the share of the battery's voltage for the winch."""
        missing = self.goal - self.height
        duty = GAINS["hold"] + GAINS["pull"] * missing - GAINS["damp"] * self.rising
        return min(MOST_DUTY, max(0.0, duty))

    def on_timer(self):
        """Send one command."""
        if self.height is None or self.goal <= 0.0:
            return
        self.winch.publish(Float32(data=self.duty()))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    rclpy.spin(Mast())


if __name__ == "__main__":
    main()
