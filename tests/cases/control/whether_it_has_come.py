"""The arrival of a message is not its data, but the conditions that decide whether and under which key it is stored are."""

import threading

import rclpy
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Bool, Float32, String


class Arrivals(Node):
    def __init__(self):
        super().__init__("arrivals")
        self.board = {}
        self.named = {}
        self.slots = [None, None]
        self.chosen = {}
        self.best = {}
        self.first = Future()
        self.large = Future()
        self.came = threading.Event()
        self.low = threading.Event()
        self.create_subscription(Float32, "range", self.on_range, 1)  # source range
        self.create_subscription(String, "name", self.on_name, 1)  # source name
        self.create_subscription(Float32, "gated", self.on_gated, 1)  # source gated
        self.pub = self.create_publisher(Bool, "there", 1)
        self.create_timer(1.0, self.tick)

    def on_range(self, msg):
        self.board["range"] = msg.data
        self.slots[0] = msg
        self.came.set()
        self.best["range"] = msg if msg.data > 3.0 else None
        if not self.first.done():
            self.first.set_result(msg.data)

    def on_name(self, msg):
        self.named[msg.data] = 1.0

    def on_gated(self, msg):
        if msg.data > 0.0:
            self.chosen["gated"] = msg
            self.slots[1] = msg
            self.large.set_result(True)
            self.low.set()
        else:
            self.low.clear()

    def tick(self):
        if "range" in self.board:
            self.pub.publish(Bool(data=True))  # clean
        if self.board.get("range") is not None:
            self.pub.publish(Bool(data=True))  # clean
        if self.slots[0] is None:
            self.pub.publish(Bool(data=False))  # clean
        if self.first.done():
            self.pub.publish(Bool(data=True))  # clean
        if self.board.get("range"):
            self.pub.publish(Bool(data=True))  # sink ~range
        if self.best.get("range") is not None:
            self.pub.publish(Bool(data=True))  # sink ~range
        if "robot" in self.named:
            self.pub.publish(Bool(data=True))  # sink ~name
        if "gated" not in self.chosen:
            self.pub.publish(Bool(data=False))  # sink ~gated
        if self.slots[1] is not None:
            self.pub.publish(Bool(data=True))  # sink ~gated
        if self.large.done():
            self.pub.publish(Bool(data=True))  # sink ~gated
        if self.came.is_set():
            self.pub.publish(Bool(data=True))  # clean
        if self.low.is_set():
            self.pub.publish(Bool(data=True))  # sink ~gated


def main():
    rclpy.init()
    rclpy.spin(Arrivals())
