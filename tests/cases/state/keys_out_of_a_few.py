import threading
from collections import Counter

import can
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64, Int32, String

counts = Counter()


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.port = can.Bus("can0")
        self.pub = self.create_publisher(Int32, "out", 1)
        self.create_subscription(Float64, "volume", self.on_volume, 1)  # source volume
        self.last, self.fixed = {}, {}
        self.text = self.create_publisher(String, "names", 1)
        self.create_subscription(String, "name", self.on_name, 1)  # source name
        self.create_timer(1.0, self.report)
        threading.Thread(target=self.listen, daemon=True).start()

    def on_volume(self, msg):
        self.fixed["volume"] = msg.data
        counts["messages"] += 1
        counts["loud" if msg.data > 0.5 else "quiet"] += 1
        self.port.send(can.Message(data=bytes([int(msg.data)])))

    def on_name(self, msg):
        self.last[msg.data] = 1.0

    def listen(self):
        for frame in self.port:
            self.pub.publish(Int32(data=frame.arbitration_id))  # clean

    def report(self):
        self.pub.publish(Int32(data=counts["messages"]))  # clean
        self.pub.publish(Int32(data=counts["quiet"]))  # sink ~volume
        self.text.publish(String(data=", ".join(self.last)))  # sink name
        self.text.publish(String(data=", ".join(self.fixed)))  # clean
        self.pub.publish(Int32(data=sum(counts.values())))  # sink ~volume


rclpy.init()
rclpy.spin(Listener())
