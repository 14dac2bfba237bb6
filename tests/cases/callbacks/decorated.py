import functools
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


def timed(function):
    @functools.wraps(function)
    def inner(self, *args, **kwargs):
        start = time.time()
        result = function(self, *args, **kwargs)
        self.get_logger().debug(f"{time.time() - start}")
        return result

    return inner


def limited(rate):
    def decorate(function):
        def inner(self, msg):
            if self.count % rate == 0:
                function(self, msg)
            self.count += 1

        return inner

    return decorate


def once(function):
    def inner(self, msg):
        self.get_logger().info("ignored")

    return inner


class Decorated(Node):
    def __init__(self):
        super().__init__("decorated")
        self.count = 0
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "timed", self.on_timed, 10)  # source timed
        self.create_subscription(Float64, "limited", self.on_limited, 10)  # source limited
        self.create_subscription(Float64, "never", self.on_never, 10)  # source never

    @timed
    def on_timed(self, msg):
        self.pub.publish(Float64(data=2.0 * msg.data))  # sink timed
        self.pub.publish(Float64(data=2.0))  # clean

    @limited(5)
    def on_limited(self, msg):
        self.pub.publish(Float64(data=msg.data))  # sink limited

    @once
    def on_never(self, msg):
        self.pub.publish(msg)  # clean


def main():
    rclpy.init()
    rclpy.spin(Decorated())
