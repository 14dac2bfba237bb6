import queue
import threading
from dataclasses import dataclass

import rospy
from std_msgs.msg import Float64


@dataclass
class Reading:
    value: float
    stamp: float = 0.0


class Node:
    limit = 3.0

    def __init__(self):
        self._level = 0.0
        self.inbox = queue.Queue()
        self.window = [0.0] * 5
        self.seen = set()
        self.by_name = {}
        self.lock = threading.Lock()
        self.latest = Reading(0.0)
        self.pair = (0.0, 1.0)
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.on_input)  # source in
        rospy.Subscriber("other", Float64, self.on_other)  # source other
        threading.Thread(target=self.work, args=(2.0,)).start()
        rospy.Timer(rospy.Duration(1.0), self.tick)

    @property
    def level(self):
        return self._level

    @level.setter
    def level(self, value):
        self._level = value

    def on_input(self, msg):
        self.inbox.put(msg)
        self.window.append(msg.data)
        self.window = self.window[1:]
        self.seen.add(msg.data)
        self.by_name.update({"in": msg.data, "fixed": 1.0})
        self.level = msg.data
        with self.lock:
            self.latest = Reading(msg.data, stamp=5.0)
            self.pair = msg.data, 6.0
        Node.limit = msg.data

    def on_other(self, msg):
        self.by_name.setdefault("other", msg.data)

    def work(self, factor):
        while True:
            item = self.inbox.get()
            self.out.publish(item.data * factor)  # sink in
            self.out.publish(factor)  # clean

    def tick(self, event):
        self.out.publish(sum(self.window))  # sink in
        self.out.publish(max(self.seen))  # sink in
        self.out.publish(self.by_name["in"])  # sink in
        self.out.publish(self.by_name["fixed"])  # clean
        self.out.publish(self.by_name["other"])  # sink other
        self.out.publish(self.level)  # sink in
        self.out.publish(self.latest.value)  # sink in
        self.out.publish(self.latest.stamp)  # clean
        self.out.publish(self.pair[0])  # sink in
        self.out.publish(self.pair[1])  # clean
        self.out.publish(self.limit)  # sink in
        a, b = self.pair
        self.out.publish(a)  # sink in
        self.out.publish(b)  # clean


Node()
rospy.spin()
