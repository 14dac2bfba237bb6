from dataclasses import dataclass, field
from typing import ClassVar

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, Int32


class Frame:
    number: int
    layout: str
    table: ClassVar[dict] = {}


@dataclass
class Speed(Frame):
    ID: ClassVar[int] = 3
    left: float
    right: float


@dataclass
class Filter:
    gain: float
    total: float = field(default=0.0, init=False)
    limit: float = 1.0


@dataclass
class Named:
    name: str = field(kw_only=True, default="x")
    value: float = 0.0


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.speed = Speed(0.0, 0.0)
        self.filter = Filter(1.0, 2.0)
        self.named = Named(0.0)
        self.pub = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, "in", self.on_speed, 1)  # source speed
        self.create_subscription(Float64, "limit", self.on_limit, 1)  # source limit
        self.create_timer(0.1, self.tick)

    def on_speed(self, msg):
        self.speed = Speed(msg.data, 2.0)

    def on_limit(self, msg):
        self.filter = Filter(1.0, msg.data)
        self.named = Named(msg.data, name="y")

    def tick(self):
        self.pub.publish(Float64(data=self.speed.left))  # sink speed
        self.pub.publish(Float64(data=self.speed.right))  # clean
        self.pub.publish(Float64(data=self.filter.limit))  # sink limit
        self.pub.publish(Float64(data=self.filter.total))  # clean
        self.pub.publish(Float64(data=self.named.value))  # sink limit
        self.pub.publish(Float64(data=float(len(self.named.name))))  # clean


rclpy.init()
rclpy.spin(Driver())
