import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, Float64MultiArray


def windows(values, size):
    for start in range(len(values) - size + 1):
        yield values[start : start + size]


def ramp(target, steps):
    for i in range(steps):
        yield target * i / steps


def chained(values):
    yield 0.0
    yield from values


def running_mean():
    total, count = 0.0, 0
    mean = None
    while True:
        value = yield mean
        total += value
        count += 1
        mean = total / count


class Generators(Node):
    def __init__(self):
        super().__init__("generators")
        self.plan = iter(())
        self.mean = running_mean()
        next(self.mean)
        self.pub = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64MultiArray, "in", self.on_in, 10)  # source value
        self.create_timer(0.1, self.tick)

    def on_in(self, msg):
        for window in windows(msg.data, 3):
            self.pub.publish(Float64(data=sum(window) / 3))  # sink value
        for step in ramp(1.0, 5):
            self.pub.publish(Float64(data=step))  # clean
        self.plan = ramp(msg.data[0], 10)
        self.pub.publish(Float64(data=list(chained(msg.data))[1]))  # sink value
        self.pub.publish(Float64(data=max(chained([1.0, 2.0]))))  # clean
        self.pub.publish(Float64(data=self.mean.send(msg.data[0])))  # sink value

    def tick(self):
        value = next(self.plan, None)
        if value is not None:
            self.pub.publish(Float64(data=value))  # sink value


def main():
    rclpy.init()
    rclpy.spin(Generators())
