import collections

import rospy
from std_msgs.msg import Float64, String


class Table:
    def __init__(self):
        self.updated = {}
        self.defaulted = {}
        self.merged = {"a": 0.0, "b": 1.0}
        self.grouped = collections.defaultdict(list)
        self.ordered = collections.OrderedDict()
        self.counts = collections.Counter()
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.text = rospy.Publisher("text", String, queue_size=1)
        rospy.Subscriber("value", Float64, self.on_value)  # source value
        rospy.Subscriber("name", String, self.on_name)  # source name
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_value(self, msg):
        self.updated.update(speed=msg.data, limit=1.0)
        self.defaulted.setdefault("speed", msg.data)
        self.merged |= {"a": msg.data}
        self.grouped["speed"].append(msg.data)
        self.ordered["x"] = msg.data

    def on_name(self, msg):
        self.counts[msg.data] += 1

    def tick(self, event):
        self.pub.publish(self.updated["speed"])  # sink value
        self.pub.publish(self.updated["limit"])  # clean
        self.pub.publish(self.defaulted["speed"])  # sink value
        self.pub.publish(self.merged["a"])  # sink value
        self.pub.publish(self.merged["b"])  # clean
        self.pub.publish(self.grouped["speed"][0])  # sink value
        self.pub.publish(self.ordered.popitem()[1])  # sink value
        self.pub.publish(max(self.counts.values()))  # sink name
        for name in self.counts:
            self.text.publish(name)  # sink name
        for name, count in self.counts.items():
            self.text.publish(name)  # sink name
        for name in self.updated:
            self.text.publish(name)  # clean
        self.text.publish(", ".join(self.counts.keys()))  # sink name


rospy.init_node("table")
Table()
rospy.spin()
