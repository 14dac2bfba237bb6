"""Several ways of keeping state on one flow: a queue in a dict on an attribute, read in a thread under a lock."""

import collections
import queue
import threading
from dataclasses import dataclass, field

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Range
from std_msgs.msg import Float64


@dataclass
class Channel:
    inbox: queue.Queue = field(default_factory=queue.Queue)
    window: collections.deque = field(default_factory=lambda: collections.deque(maxlen=3))
    scale: float = 1.0


class Fusion(Node):
    def __init__(self):
        super().__init__("fusion")
        self.lock = threading.Lock()
        self.channels = {"left": Channel(), "right": Channel(scale=2.0)}
        self.estimates = {"left": 0.0, "right": 0.0}
        self.pub = self.create_publisher(Float64, "fused", 10)
        self.create_subscription(Range, "left", self.on_left, 10)  # source left
        self.create_subscription(Range, "right", self.on_right, 10)  # source right
        threading.Thread(target=self.filter, daemon=True).start()
        self.create_timer(0.1, self.tick)

    def on_left(self, msg):
        self.channels["left"].inbox.put(msg)

    def on_right(self, msg):
        with self.lock:
            self.channels["right"].window.append(msg.range)

    def filter(self):
        while rclpy.ok():
            msg = self.channels["left"].inbox.get()
            with self.lock:
                self.estimates["left"] = msg.range * self.channels["left"].scale

    def tick(self):
        with self.lock:
            left = self.estimates["left"]
            right = sum(self.channels["right"].window)
        self.pub.publish(Float64(data=left))  # sink left
        self.pub.publish(Float64(data=right))  # sink right
        self.pub.publish(Float64(data=self.estimates["right"]))  # clean
        self.pub.publish(Float64(data=self.channels["right"].scale))  # clean


def main():
    rclpy.init()
    rclpy.spin(Fusion())
