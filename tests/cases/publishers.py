import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

TOPICS = ["first", "second"]


class Base(Node):
    def __init__(self, name, topic="raw"):
        super().__init__(name)
        self.topic = topic
        self.pubs = {}
        self.listed = [self.create_publisher(Float64, t, 10) for t in TOPICS]
        self.sub = self.create_subscription(Float64, f"{name}/{topic}", self.on_input, 10)  # source in

    def on_input(self, msg):
        raise NotImplementedError


class Child(Base):
    def __init__(self):
        super().__init__("child", topic="input")
        self.pubs["main"] = self.create_publisher(Float64, "main", 10)
        for name in TOPICS:
            self.pubs[name] = self.create_publisher(Float64, name, 10)
        self.value = 0.0

    def on_input(self, msg):
        self.pubs["main"].publish(msg.data)  # sink in
        for pub in self.listed:
            pub.publish(2 * msg.data)  # sink in
        for name, pub in self.pubs.items():
            pub.publish(Float64(data=msg.data))  # sink in
        first = self.listed[0]
        first.publish(Float64())  # clean
        self.send(self.pubs["main"], msg)
        self.publish(msg)
        getter(self)().publish(msg)  # sink in

    def send(self, where, what):
        where.publish(what)  # sink in

    def publish(self, msg):
        self.value = msg.data

    def choose(self):
        return self.listed[1]


def getter(node):
    return node.choose


class Relay(Base):
    def on_input(self, msg):
        super_pub.publish(msg)  # sink in


def main():
    global super_pub
    rclpy.init()
    node = Child()
    super_pub = node.create_publisher(Float64, "super", 10)
    relay = Relay("relay")
    executor = rclpy.executors.MultiThreadedExecutor()
    executor.add_node(node)
    executor.add_node(relay)
    executor.spin()
