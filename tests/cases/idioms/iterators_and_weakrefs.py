"""itertools and operator, weak references to listeners, iterators of one's own, sorting by attributes."""

import itertools
import operator
import weakref

import rclpy
from geometry_msgs.msg import PoseArray
from rclpy.node import Node
from std_msgs.msg import Float64, Int32, String


class Window:
    def __init__(self, size):
        self.size = size
        self.items = []

    def push(self, item):
        self.items = [*self.items[-self.size + 1 :], item]

    def __iter__(self):
        return iter(self.items)

    def __len__(self):
        return len(self.items)


class Display:
    def __init__(self, node):
        self.pub = node.create_publisher(Float64, "shown", 10)

    def show(self, value):
        self.pub.publish(Float64(data=value))  # sink value


class Source(Node):
    def __init__(self):
        super().__init__("source")
        self.listeners = weakref.WeakSet()
        self.display = Display(self)
        self.listeners.add(self.display)
        self.again = weakref.WeakMethod(self.display.show)
        self.owner = weakref.ref(self)
        self.window = Window(5)
        self.colors = itertools.cycle(["red", "green"])
        self.numbers = itertools.count(1)
        self.total = self.create_publisher(Float64, "total", 10)
        self.nearest = self.create_publisher(Float64, "nearest", 10)
        self.color = self.create_publisher(String, "color", 10)
        self.number = self.create_publisher(Int32, "number", 10)
        self.create_subscription(Float64, "value", self.on_value, 10)  # source value
        self.create_subscription(PoseArray, "poses", self.on_poses, 10)  # source poses

    def on_value(self, msg):
        self.window.push(msg.data)
        for listener in self.listeners:
            listener.show(msg.data)
        show = self.again()
        if show is not None:
            show(0.5 * msg.data)
        *_, total = itertools.accumulate(self.window)
        self.total.publish(Float64(data=total))  # sink value
        self.color.publish(String(data=next(self.colors)))  # clean
        self.number.publish(Int32(data=next(self.numbers)))  # clean

    def on_poses(self, msg):
        points = sorted((p.position for p in msg.poses), key=operator.attrgetter("x"))
        for first, second in itertools.pairwise(points):
            self.nearest.publish(Float64(data=second.x - first.x))  # sink poses
        ahead = itertools.takewhile(lambda p: p.x < 2.0, points)
        self.nearest.publish(Float64(data=sum(map(operator.attrgetter("y"), ahead))))  # sink poses
        grouped = {k: list(g) for k, g in itertools.groupby(points, key=lambda p: p.y > 0)}
        self.number.publish(Int32(data=len(grouped)))  # sink poses
        self.owner().color.publish(String(data="poses"))  # clean


def main():
    rclpy.init()
    rclpy.spin(Source())


if __name__ == "__main__":
    main()
