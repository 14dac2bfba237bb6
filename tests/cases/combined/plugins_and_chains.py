import rclpy
import threading
from queue import Empty, Queue
from typing import Dict, Type
from rclpy.node import Node
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float32, String, Bool
from std_srvs.srv import SetBool
from geometry_msgs.msg import Twist


class Plugin:
    registry: Dict[str, Type["Plugin"]] = {}

    def __init_subclass__(cls, name="", **kwargs):
        super().__init_subclass__(**kwargs)
        Plugin.registry[name] = cls

    def compute(self, x):
        raise NotImplementedError

    def __repr__(self):
        return type(self).__name__


class Linear(Plugin, name="linear"):
    gain = 2.0

    def compute(self, x):
        return self.gain * x


class Quiet(Plugin, name="quiet"):
    def compute(self, x):
        return 0.0


class Meta(type):
    def __call__(cls, *args, **kwargs):
        obj = super().__call__(*args, **kwargs)
        obj.ready = True
        return obj


class Holder(metaclass=Meta):
    def __init__(self, v):
        self.v = v


class Chain:
    def __init__(self, *stages):
        self.stages = list(stages)

    def __rshift__(self, stage):
        self.stages.append(stage)
        return self

    def __call__(self, value):
        for stage in self.stages:
            value = stage(value)
        return value


class Host(Node):
    def __init__(self, **kw):
        super().__init__("host", **kw)
        self.plugin = Plugin.registry[self.declare_parameter("plugin", "linear").value]()
        self.quiet = Quiet()
        self.inbox: "Queue[float]" = Queue()
        self.pub = self.create_publisher(Float32, "out", 1)
        self.info = self.create_publisher(String, "info", 1)
        self.create_subscription(Float32, "x", self.on_x, 1)  # source x
        self.create_subscription(Float32, "y", self.inbox.put, 1)  # source y
        self.chain = Chain(abs) >> (lambda v: v + 1) >> self.plugin.compute
        self.worker = threading.Thread(target=self._work, daemon=True)
        self.worker.start()

    def on_x(self, msg):
        self.pub.publish(Float32(data=self.plugin.compute(msg.data)))  # sink x
        self.pub.publish(Float32(data=self.quiet.compute(msg.data)))  # clean
        self.pub.publish(Float32(data=self.chain(msg.data)))  # sink x
        self.info.publish(String(data=repr(self.plugin)))  # clean
        h = Holder(msg.data)
        self.pub.publish(Float32(data=h.v))  # sink x
        self.info.publish(String(data=str(h.ready)))  # clean
        self.pub.publish(Float32(data=self.plugin.gain))  # clean

    def _work(self):
        while rclpy.ok():
            try:
                item = self.inbox.get(timeout=0.5)
            except Empty:
                self.info.publish(String(data="idle"))  # clean
                continue
            self.pub.publish(Float32(data=item.data))  # sink y
            self.inbox.task_done()


def main(args=None):
    rclpy.init(args=args)
    host = Host()
    try:
        rclpy.spin(host)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        host.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
