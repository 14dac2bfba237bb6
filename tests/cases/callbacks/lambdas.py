import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

TOPICS = ["left", "right"]


class Lambdas(Node):
    def __init__(self):
        super().__init__("lambdas")
        self.values = {}
        self.stopped = False
        self.pub = self.create_publisher(Float64, "out", 10)
        self.flag = self.create_publisher(Bool, "flag", 10)
        for topic in TOPICS:
            self.create_subscription(Float64, topic, lambda msg, name=topic: self.store(name, msg), 10)  # source wheels
        self.create_subscription(Float64, "direct", lambda msg: self.pub.publish(msg), 10)  # source direct # sink direct
        self.create_subscription(Float64, "ignored", lambda _: self.flag.publish(Bool(data=True)), 10)  # source ignored # clean
        self.create_subscription(Bool, "stop", lambda m: setattr(self, "stopped", m.data), 10)  # source stop
        self.create_timer(0.1, lambda: self.pub.publish(Float64(data=self.values["left"])))  # sink wheels
        self.create_timer(0.1, lambda: self.flag.publish(Bool(data=self.stopped)))  # sink stop
        self.create_timer(0.1, lambda: self.flag.publish(Bool(data=False)))  # clean

    def store(self, name, msg):
        self.values[name] = msg.data


def main():
    rclpy.init()
    rclpy.spin(Lambdas())
