#!/usr/bin/env python3
"""Hold the depth of a small ROV."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Depth(Node):
    """Depth to vertical thrust."""

    STIFFNESS = 1.4  # thrust per metre

    def __init__(self):
        super().__init__("depth")
        self.goal = None
        self.create_subscription(Float64, "goal", self.on_goal, 10)
        self.create_subscription(Float64, "depth", self.on_depth, 10)
        self.pub = self.create_publisher(Float64, "vertical", 10)

    def on_goal(self, msg):
        """Store the depth to hold, m."""
        self.goal = msg.data

    def on_depth(self, msg):
        """Thrust down or up."""
        if self.goal is None:
            return
        thrust = self.thrust(self.goal - msg.data)
        self.pub.publish(Float64(data=thrust))

    def thrust(self, error):
        """Return the thrust for an error of depth."""
        return self.STIFFNESS * error


def main():
    """Run the node."""
    rclpy.init()
    rclpy.spin(Depth())


if __name__ == "__main__":
    main()
