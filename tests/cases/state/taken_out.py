from collections import deque

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, Int32


class Orders(Node):
    def __init__(self):
        super().__init__("orders")
        self.todo = deque()
        self.held = []
        self.spare = deque()
        self.pub = self.create_publisher(Int32, "left", 1)
        self.create_subscription(Float64, "order", self.on_order, 1)  # source order
        self.create_subscription(Float64, "reached", self.on_reached, 1)  # source reached
        self.create_subscription(Bool, "drop", self.on_drop, 1)  # source drop
        self.create_timer(0.1, self.tick)

    def on_order(self, msg):
        self.todo.append(1)
        self.held.append(2)
        self.spare.append(3)

    def on_reached(self, msg):
        if msg.data < 0.3:
            self.todo.popleft()

    def on_drop(self, msg):
        if msg.data:
            self.held.clear()
        self.spare.pop()

    def tick(self):
        if self.todo:
            self.pub.publish(Int32(data=1))  # sink ~reached
        self.pub.publish(Int32(data=len(self.held)))  # sink ~drop
        if len(self.spare) > 2:
            self.pub.publish(Int32(data=2))  # clean
        self.pub.publish(Int32(data=3))  # clean


rclpy.init()
rclpy.spin(Orders())
