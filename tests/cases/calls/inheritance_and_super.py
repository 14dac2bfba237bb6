import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Logger:
    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.lines = []

    def note(self, value):
        self.lines.append(value)
        return value


class Filter:
    def __init__(self, gain=1.0):
        self.gain = gain
        self.value = 0.0

    def update(self, value):
        self.value = self.gain * value
        return self.value

    def name(self):
        return "filter"


class LoggedFilter(Logger, Filter):
    def update(self, value):
        filtered = super().update(value)
        return self.note(filtered)

    def name(self):
        return "logged " + super().name()


class Fixed(Filter):
    def update(self, value):
        return 1.0


class TwoStep(LoggedFilter):
    def update(self, value):
        return LoggedFilter.update(self, value) + Filter.update(self, 0.0)


class Chain(Node):
    def __init__(self):
        super().__init__("chain")
        self.filters = {"a": LoggedFilter(gain=0.5), "b": Fixed(), "c": TwoStep(gain=0.5)}
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "in", self.on_in, 10)  # source value

    def on_in(self, msg):
        self.send(self.filters["a"].update(msg.data))
        self.pub.publish(Float64(data=self.filters["b"].update(msg.data)))  # clean
        self.pub.publish(Float64(data=self.filters["c"].update(msg.data)))  # sink value
        self.pub.publish(Float64(data=self.filters["a"].lines[0]))  # sink value
        self.pub.publish(Float64(data=float(len(self.filters["a"].name()))))  # clean
        self.pub.publish(Float64(data=self.filters["b"].gain))  # clean

    def send(self, value):
        self.pub.publish(Float64(data=value))  # sink value


def main():
    rclpy.init()
    rclpy.spin(Chain())
