from collections import deque

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Average(Node):
    def __init__(self):
        super().__init__("average")
        self.window = deque(maxlen=5)
        self.left = deque()
        self.constant = deque([1.0, 2.0])
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value
        self.create_timer(1.0, self.tick)

    def on_in(self, msg):
        self.window.append(msg.data)
        self.left.appendleft(msg)
        self.constant.rotate(1)

    def tick(self):
        self.pub.publish(Float64(data=sum(self.window) / len(self.window)))  # sink value
        self.pub.publish(self.left.pop())  # sink value
        self.pub.publish(Float64(data=self.constant[0]))  # clean
        self.pub.publish(Float64(data=float(self.window.maxlen)))  # clean
        newest = self.window[-1] - self.window[0]
        self.pub.publish(Float64(data=newest))  # sink value
        while self.left:
            item = self.left.popleft()
            self.pub.publish(item)  # sink value


def main():
    rclpy.init()
    rclpy.spin(Average())
