#!/usr/bin/env python3
"""Move the trolley of an overhead crane so that the load hangs still at the end."""

import rclpy
from rclpy.node import Node
from shaper import ZeroVibration
from std_msgs.msg import Bool, Float64

SLING = 1.0  # distance from the hook to the centre of the load (m)
PERIOD = 0.1  # s
TOP_SPEED = 0.8  # m/s
CREEP_SPEED = 0.05
CREEP_WITHIN = 0.03
STOPPING = 0.24  # distance that the drive needs to stop from top speed, m


class Trolley(Node):
    """Compute the raw command from the distance, shape it, and send it to the drive."""

    def __init__(self):
        super().__init__("trolley")
        self.goal = None
        self.start = None
        self.hoist = None
        self.run_time = None
        self.elapsed = 0.0
        self.shaper = ZeroVibration(PERIOD)
        self.create_subscription(Float64, "goal", self.on_goal, 1)
        self.create_subscription(Float64, "trolley/position", self.on_position, 1)
        self.create_subscription(Float64, "hoist/length", self.on_hoist, 1)
        self.speed_pub = self.create_publisher(Float64, "trolley/speed", 1)
        self.lower_pub = self.create_publisher(Bool, "hoist/lower", 1)
        self.create_timer(PERIOD, self.control)

    def on_goal(self, msg):
        """Store the goal of the load."""
        self.goal = msg.data

    def on_position(self, msg):
        """Store the start position of the trolley."""
        if self.start is None:
            self.start = msg.data

    def on_hoist(self, msg):
        """Store the smoothed length of rope."""
        self.hoist = msg.data if self.hoist is None else 0.9 * self.hoist + 0.1 * msg.data

    def raw_speed(self):
        """Return the unshaped speed: top speed until the distance is covered."""
        left = self.goal - self.start - TOP_SPEED * self.elapsed
        return max(0.0, min(TOP_SPEED, left / PERIOD))

    def control(self):
        """Run one cycle."""
        if self.goal is None or self.start is None or self.hoist is None:
            return
        raw = self.raw_speed()
        self.elapsed += PERIOD
        length = self.hoist + SLING
        self.speed_pub.publish(Float64(data=self.shaper.shape(raw, length)))
        self.lower_pub.publish(Bool(data=raw == 0.0 and self.shaper.settled(0.0)))


def main():
    """Spin the node."""
    rclpy.init()
    rclpy.spin(Trolley())


if __name__ == "__main__":
    main()
