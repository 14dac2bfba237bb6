"""The helper with which plugins register their callbacks."""

import rclpy


def wire(kind, topic, callback):
    node = rclpy.create_node("plugin")
    node.create_subscription(kind, topic, callback, 1)
    return node
