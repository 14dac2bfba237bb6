"""State at class level: a shared dict, a singleton by `__new__`, class methods, and a counter of instances."""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from std_msgs.msg import Float64, Int32


class Store:
    _instance = None

    def __new__(cls):
        if cls._instance is None:
            cls._instance = super().__new__(cls)
            cls._instance.values = {}
        return cls._instance

    def put(self, key, value):
        self.values[key] = value

    def get(self, key, default=0.0):
        return self.values.get(key, default)


class Config:
    scale = 2.0
    offset = 0.0

    @classmethod
    def calibrate(cls, offset):
        cls.offset = offset

    @staticmethod
    def apply(value):
        return Config.scale * value + Config.offset


class Channel:
    made = 0
    latest = {}

    def __init__(self, node, name):
        Channel.made += 1
        self.name = name
        self.pub = node.create_publisher(Float64, f"{name}/scaled", 10)
        node.create_subscription(Temperature, name, self.on_message, 10)  # source temperature

    def on_message(self, msg):
        self.latest[self.name] = msg.temperature
        Store().put(self.name, msg.variance)
        self.pub.publish(Float64(data=Config.apply(1.0)))  # sink offset


class Hub(Node):
    def __init__(self):
        super().__init__("hub")
        self.channels = [Channel(self, n) for n in ("inside", "outside")]
        self.made = self.create_publisher(Int32, "made", 10)
        self.mean = self.create_publisher(Float64, "mean", 10)
        self.variance = self.create_publisher(Float64, "variance", 10)
        self.create_subscription(Float64, "offset", lambda m: Config.calibrate(m.data), 10)  # source offset
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.made.publish(Int32(data=Channel.made))  # clean
        if Channel.latest:
            self.mean.publish(Float64(data=sum(Channel.latest.values()) / len(Channel.latest)))  # sink temperature
        self.variance.publish(Float64(data=Store().get("inside")))  # sink temperature
        self.mean.publish(Float64(data=Config.scale))  # clean


def main():
    rclpy.init()
    rclpy.spin(Hub())


if __name__ == "__main__":
    main()
