#!/usr/bin/env python3
"""Balance a pole on a cart: push to the side that a weighted sum of place, speed, angle and swing points to."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, Float64MultiArray

PLACE, SPEED, ANGLE, SWING = 0.1, 0.3, 1.0, 0.3  # weights: 1/m, s/m, 1/rad, s/rad


class Balance(Node):
    """Answer every state with a push."""

    def __init__(self):
        super().__init__("balance")
        self.create_subscription(Float64MultiArray, "/state", self.on_state, 10)
        self.push = self.create_publisher(Float64, "/push", 10)

    def on_state(self, msg):
        """Push towards the side where the pole and the cart go."""
        place, speed, angle, swing = msg.data
        side = PLACE * place + SPEED * speed + ANGLE * angle + SWING * swing
        self.push.publish(Float64(data=side))


def main():
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Balance()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
