from abc import ABC, abstractmethod

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Controller(Node, ABC):
    topic = "error"

    def __init__(self, name):
        super().__init__(name)
        self.pub = self.create_publisher(Float64, "command", 10)
        self.sub = self.create_subscription(Float64, self.topic, self._on_error, 10)  # source error

    def _on_error(self, msg):
        self.pub.publish(Float64(data=self.command(msg.data)))  # sink error
        self.pub.publish(Float64(data=self.idle()))  # clean

    @abstractmethod
    def command(self, error): ...

    def idle(self):
        return 0.0


class Proportional(Controller):
    def __init__(self):
        super().__init__("p")
        self.gain = 0.4

    def command(self, error):
        return self.gain * error


class Constant(Controller):
    def __init__(self):
        super().__init__("c")

    def command(self, error):
        return 1.0


def main():
    rclpy.init()
    executor = rclpy.executors.MultiThreadedExecutor()
    for node in (Proportional(), Constant()):
        executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
