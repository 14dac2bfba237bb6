import struct
from dataclasses import asdict, astuple, dataclass
from operator import attrgetter, itemgetter

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_msgs.msg import Float64, Int64, String


class Frame:
    LAYOUT = ""
    kinds = {}

    def __init_subclass__(cls, **options):
        super().__init_subclass__(**options)
        Frame.kinds[cls.NUMBER] = cls

    def pack(self):
        return struct.pack(self.LAYOUT, *astuple(self))

    @classmethod
    def unpack(cls, data):
        return cls(*struct.unpack(cls.LAYOUT, data))


@dataclass
class Encoder(Frame):
    NUMBER = 1
    LAYOUT = "<ii"
    left: int
    right: int


@dataclass
class Gains:
    kp: float = 1.0
    kd: float = 0.1
    error: float = 0.0


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.left = 0
        self.gains = {"arm": Gains()}
        self.client = self.create_client(AddTwoInts, "add")
        self.pub = self.create_publisher(Int64, "out", 1)
        self.text = self.create_publisher(String, "text", 1)
        self.create_subscription(Int64, "ticks", self.on_ticks, 1)  # source ticks
        self.create_subscription(Float64, "error", self.on_error, 1)  # source error
        self.create_timer(0.1, self.tick)

    def on_ticks(self, msg):
        self.left = msg.data
        request = AddTwoInts.Request(a=msg.data)
        self.client.call_async(request).add_done_callback(self.on_sum)

    def on_sum(self, future):
        self.pub.publish(Int64(data=future.result().sum))  # sink ticks

    def on_error(self, msg):
        self.gains["arm"].error = msg.data

    def tick(self):
        data = Encoder(self.left, 2).pack()
        match Frame.kinds.get(1).unpack(data):
            case Encoder(left=left):
                self.pub.publish(Int64(data=left))  # sink ticks
        gains = self.gains["arm"]
        self.text.publish(String(data=str(attrgetter("kp", "kd")(gains))))  # clean
        self.text.publish(String(data=str(attrgetter("kp", "error")(gains))))  # sink error
        self.text.publish(String(data=str(astuple(gains)[0])))  # clean
        self.text.publish(String(data=str(itemgetter("kd")(asdict(gains)))))  # clean
        self.text.publish(String(data=str(itemgetter("error")(asdict(gains)))))  # sink error


rclpy.init()
rclpy.spin(Driver())
