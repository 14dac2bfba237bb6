import rclpy
from functools import partial, lru_cache, cached_property, singledispatch, singledispatchmethod
from rclpy.node import Node
from std_msgs.msg import Float32, Int32, String


def debounce(n):
    def deco(fn):
        count = 0

        def wrapper(self, msg):
            nonlocal count
            count += 1
            if count >= n:
                count = 0
                fn(self, msg)
        return wrapper
    return deco


def make_filter(alpha):
    value = None

    def step(x):
        nonlocal value
        value = x if value is None else alpha * x + (1 - alpha) * value
        return value

    def reset():
        nonlocal value
        value = None

    step.reset = reset
    return step


class N(Node):
    def __init__(self):
        super().__init__("n")
        self.filters = {name: make_filter(0.2) for name in ("a", "b")}
        self.fa, self.fb = make_filter(0.1), make_filter(0.5)
        self.outs = {}
        for name in ("a", "b"):
            self.outs[name] = self.create_publisher(Float32, f"out/{name}", 1)
            self.create_subscription(Float32, f"in/{name}", partial(self.on, name=name), 1)  # source ab
        self.create_subscription(Float32, "c", self.on_c, 1)  # source c
        self.create_subscription(Float32, "d", lambda m: self.outs["a"].publish(Float32(data=self.fb(m.data))), 1)  # source d # sink d
        self.extra = self.create_publisher(Float32, "extra", 1)
        self.create_subscription(String, "e", self.on_e, 1)  # source e

    def on(self, msg, *, name):
        self.outs[name].publish(Float32(data=self.filters[name](msg.data)))  # sink ab

    @debounce(3)
    def on_c(self, msg):
        self.extra.publish(Float32(data=self.fa(msg.data)))  # sink c
        self.extra.publish(Float32(data=self.scale(2.0)))  # clean
        self.extra.publish(Float32(data=self.scale(msg.data)))  # sink c

    @lru_cache(maxsize=None)
    def scale(self, x):
        return 3.0 * x

    @cached_property
    def gain(self):
        return 2.0

    def on_e(self, msg):
        self.show(msg.data)
        self.extra.publish(Float32(data=self.gain))  # clean

    @singledispatchmethod
    def show(self, what):
        self.extra.publish(Float32(data=float(what)))  # sink e


def main():
    rclpy.init()
    rclpy.spin(N())
