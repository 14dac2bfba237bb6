import numpy as np
import range_methods
import rospy
import structs
from std_msgs.msg import Float32MultiArray, Float64


class Filter:
    def __init__(self):
        self.pub = rospy.Publisher("out", Float32MultiArray, queue_size=1)
        self.weights = np.ones(100) / 100
        self.ranges = np.zeros((100, 4), dtype=np.float32)
        self.shown = np.zeros(4)
        self.kept = np.zeros(4)
        self.saved = np.full(4, 1.0)
        self.packed = bytearray(8)
        self.named = np.empty(4)
        self.told = np.empty(4)
        self.limit = 4.0
        self.model = range_methods.Model(100)
        rospy.Subscriber("scan", Float32MultiArray, self.on_scan)  # source scan

    def on_scan(self, msg):
        observed = np.array(msg.data)
        self.model.evaluate(observed, self.weights, 4)
        self.pub.publish(self.weights / np.sum(self.weights))  # sink scan
        range_methods.repeat(observed, self.ranges)
        self.pub.publish(self.ranges[0])  # sink scan
        structs.pack(self.packed, msg.data[0])
        self.pub.publish(self.packed)  # sink scan
        np.save("file", self.saved, msg.data)
        self.pub.publish(self.saved)  # clean
        self.model.draw(self.shown, observed)
        self.pub.publish(self.shown)  # clean
        result = self.model.distance(observed, self.kept)
        self.pub.publish(self.kept)  # clean
        self.pub.publish(result)  # sink scan
        self.model.accumulate(observed, into=self.named)
        self.pub.publish(self.named)  # sink scan
        self.model.save(observed, into=self.told)
        self.pub.publish(self.told)  # clean
        self.model.evaluate(observed, self.limit)
        self.pub.publish(self.limit)  # clean


rospy.init_node("filter")
limit = rospy.Publisher("limit", Float64, queue_size=1)
Filter()
rospy.spin()
