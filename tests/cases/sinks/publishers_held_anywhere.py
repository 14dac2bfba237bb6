import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

module_pub = None


def make(node, topic):
    return node.create_publisher(Float64, topic, 10)


def send(pub, msg):
    pub.publish(msg)  # sink value


def send_fixed(pub):
    pub.publish(Float64(data=0.0))  # clean


class Output:
    def __init__(self, node):
        self.pub = make(node, "held")

    def write(self, msg):
        self.pub.publish(msg)  # sink value


class Holder(Node):
    def __init__(self):
        global module_pub
        super().__init__("holder")
        module_pub = make(self, "module")
        self.pub = self.create_publisher(Float64, "attribute", 10)
        self.by_name = {"a": make(self, "a"), "b": make(self, "b")}
        self.listed = [make(self, f"list{i}") for i in range(3)]
        self.pair = (make(self, "first"), make(self, "second"))
        self.output = Output(self)
        self.publish_later = self.pub.publish
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value

    @property
    def current(self):
        return self.listed[0]

    def choose(self, name):
        return self.by_name.get(name)

    def on_in(self, msg):
        local = self.create_publisher(Float64, "local", 10)
        local.publish(msg)  # sink value
        self.pub.publish(msg)  # sink value
        module_pub.publish(msg)  # sink value
        self.by_name["a"].publish(msg)  # sink value
        self.choose("b").publish(msg)  # sink value
        self.listed[1].publish(msg)  # sink value
        self.current.publish(msg)  # sink value
        self.pair[0].publish(msg)  # sink value
        self.output.write(msg)
        self.publish_later(msg)  # sink value
        getattr(self, "pub").publish(msg)  # sink value
        for pub in self.by_name.values():
            pub.publish(msg)  # sink value
        send(self.pub, msg)
        send_fixed(self.pub)
        (self.pub if msg.data > 0 else local).publish(Float64())  # sink ~value


def main():
    rclpy.init()
    rclpy.spin(Holder())
