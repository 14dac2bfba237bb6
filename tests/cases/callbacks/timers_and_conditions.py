import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Late(Node):
    def __init__(self):
        super().__init__("late")
        self.value = None
        self.timer = None
        self.pub = self.create_publisher(Float64, "out", 10)
        self.sub = self.create_subscription(Float64, "first", self.on_first, 10)  # source first

    def on_first(self, msg):
        self.value = msg.data
        self.timer = self.create_timer(1.0, self.on_timer)
        self.destroy_subscription(self.sub)
        self.sub = self.create_subscription(Float64, "second", self.on_second, 10)  # source second

    def on_second(self, msg):
        self.pub.publish(msg)  # sink second

    def on_timer(self):
        self.pub.publish(Float64(data=self.value))  # sink first
        self.pub.publish(Float64(data=1.0))  # clean


def main(args=None):
    rclpy.init(args=args)
    node = Late()
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.1)
