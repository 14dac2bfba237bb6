import rclpy
from rclpy.node import Node
from std_msgs.msg import Int64, Float64, String
from example_interfaces.srv import AddTwoInts
from functools import partial
import random
import copy


class Counter(Node):
    total: int = 0

    def __init__(self):
        super().__init__("counter")
        self.counter_ = 0
        self.msg = Float64()
        self.buffer = [None] * 5
        self.idx = 0
        self.pairs = []
        self.window = tuple()
        self.lookup = {}
        self.flags = {"a": False, "b": False}
        self.sub = self.create_subscription(Int64, "number", self.callback_number, 10)  # source num
        self.sub2 = self.create_subscription(Float64, "level", self.callback_level, 10)  # source lvl
        self.pub = self.create_publisher(Int64, "count", 10)
        self.pub_f = self.create_publisher(Float64, "f", 10)
        self.pub_s = self.create_publisher(String, "s", 10)
        self.server = self.create_service(AddTwoInts, "reset", self.callback_reset)
        self.client = self.create_client(AddTwoInts, "add")
        self.timer = self.create_timer(1.0, self.on_timer)

    def callback_number(self, msg):
        self.counter_ += msg.data
        Counter.total += msg.data
        new = Int64()
        new.data = self.counter_
        self.pub.publish(new)  # sink num
        self.call(msg.data, 3)

    def callback_level(self, msg):
        self.buffer[self.idx] = msg.data
        self.idx = (self.idx + 1) % len(self.buffer)
        self.pairs.append((self.idx, msg.data))
        self.window = self.window[1:] + (msg.data,)
        self.lookup.setdefault("level", []).append(msg.data)
        self.flags["a"] = msg.data > 3.0

    def callback_reset(self, request, response):
        self.counter_ = 0
        response.sum = 0
        return response

    def call(self, a, b):
        req = AddTwoInts.Request()
        req.a, req.b = a, b
        future = self.client.call_async(req)
        future.add_done_callback(partial(self.done, a=a))

    def done(self, future, a):
        try:
            response = future.result()
            self.pub_f.publish(Float64(data=float(response.sum)))  # sink num
            self.pub.publish(Int64(data=a))  # sink num
        except Exception as e:
            self.get_logger().error("Service call failed %r" % (e,))

    def on_timer(self):
        self.pub.publish(Int64(data=Counter.total))  # sink num
        self.pub.publish(Int64(data=self.idx))  # clean
        self.pub_f.publish(Float64(data=sum(v for v in self.buffer if v is not None)))  # sink lvl
        self.pub.publish(Int64(data=self.pairs[-1][0] if self.pairs else 0))  # clean
        self.pub_f.publish(Float64(data=self.pairs[-1][1]))  # sink lvl
        self.pub_f.publish(Float64(data=self.window[0]))  # sink lvl
        self.pub_f.publish(Float64(data=max(self.lookup.get("level", [0.0]))))  # sink lvl
        self.pub_s.publish(String(data="on" if self.flags["a"] else "off"))  # sink ~lvl
        self.pub_s.publish(String(data="on" if self.flags["b"] else "off"))  # clean
        self.msg.data = random.random()
        self.pub_f.publish(self.msg)  # clean


def main(args=None):
    rclpy.init(args=args)
    node = Counter()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
