import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class Guarded(Node):
    def __init__(self):
        super().__init__("guarded")
        self.lock = threading.RLock()
        self.value = 0.0
        self.limit = 1.0
        group = ReentrantCallbackGroup()
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10, callback_group=group)  # source value
        self.create_timer(0.1, self.tick, callback_group=group)

    def on_in(self, msg):
        with self.lock:
            self.value = msg.data

    def tick(self):
        with self.lock:
            value = self.value
            limit = self.limit
        self.pub.publish(Float64(data=value))  # sink value
        self.pub.publish(Float64(data=limit))  # clean
        self.lock.acquire()
        try:
            again = self.value
        finally:
            self.lock.release()
        self.pub.publish(Float64(data=again))  # sink value


def main():
    rclpy.init()
    node = Guarded()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        executor.shutdown()
        node.destroy_node()
