"""A base class whose helper registers the endpoints; its subclasses only declare them."""

from rclpy.node import Node
from std_msgs.msg import Float64


class Offering(Node):
    def __init__(self, name):
        super().__init__(name)
        self.level = 0.0
        self.out = self.create_publisher(Float64, "out", 1)
        for kind, topic, handler in self.offers():
            self.create_subscription(kind, topic, handler, 1)  # source level

    def offers(self):
        return []
