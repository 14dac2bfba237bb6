import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Router(Node):
    def __init__(self):
        super().__init__("router")
        self.speed = 0.0
        self.height = 0.0
        self.unused = 0.0
        self.pub = self.create_publisher(Float64, "out", 10)
        handlers = {
            "speed": (Float64, self.on_speed),
            "height": (Float64, self.on_height),
        }
        for topic, (kind, handler) in handlers.items():
            self.create_subscription(kind, topic, handler, 10)  # source loop
        self.by_name = {"go": self.on_go, "unused": self.on_unused}
        self.create_subscription(Bool, "go", self.by_name["go"], 10)  # source go
        self.create_timer(0.1, self.tick)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_height(self, msg):
        self.height = msg.data

    def on_unused(self, msg):
        self.unused = msg.data

    def on_go(self, msg):
        self.pub.publish(Float64(data=float(msg.data)))  # sink go

    def tick(self):
        self.pub.publish(Float64(data=self.speed))  # sink loop
        self.pub.publish(Float64(data=self.height))  # sink loop
        self.pub.publish(Float64(data=self.unused))  # clean


def main():
    rclpy.init()
    rclpy.spin(Router())
