import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Early(Node):
    def __init__(self):
        super().__init__("early")
        self.enabled = False
        self.level = 0.0
        self.latest = None
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Bool, "enable", self.on_enable, 10)  # source enable
        self.create_subscription(Float64, "level", self.on_level, 10)  # source level
        self.create_timer(0.1, self.tick)

    def on_enable(self, msg):
        if self.enabled == msg.data:
            return
        self.enabled = msg.data
        self.pub.publish(Float64(data=1.0))  # sink ~enable

    def on_level(self, msg):
        if msg.data < 0.0:
            self.get_logger().warn("negative")
            return
        self.level = msg.data
        self.latest = msg

    def allowed(self):
        if not self.enabled:
            return False
        return True

    def gain(self):
        if self.level > 1.0:
            return 0.5
        return 1.0

    def tick(self):
        self.pub.publish(Float64(data=9.0))  # clean
        self.pub.publish(Float64(data=self.gain()))  # sink ~level
        if self.latest is None:
            return
        self.pub.publish(Float64(data=8.0))  # sink ~level
        if not self.allowed():
            return
        self.pub.publish(Float64(data=2.0))  # sink ~enable ~level
        self.send(3.0)

    def send(self, value):
        self.pub.publish(Float64(data=value))  # sink ~enable ~level


def main():
    rclpy.init()
    rclpy.spin(Early())
