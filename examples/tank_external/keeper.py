#!/usr/bin/env python3
"""Fill a tank: open the valve in proportion to what is missing."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

TARGET = 1.0  # m
GAIN = 2.0  # 1/s


class Keeper(Node):
    """Command the valve ten times a second."""

    def __init__(self):
        super().__init__("keeper")
        self.level = None
        self.create_subscription(Float64, "/level", self.on_level, 10)
        self.valve = self.create_publisher(Float64, "/valve", 10)
        self.create_timer(0.1, self.on_timer)

    def on_level(self, msg):
        """Keep the newest level, in m."""
        self.level = msg.data

    def on_timer(self):
        """Command the inflow, in m/s."""
        if self.level is not None:
            missing = TARGET - self.level
            self.valve.publish(Float64(data=GAIN * missing))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Keeper()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
