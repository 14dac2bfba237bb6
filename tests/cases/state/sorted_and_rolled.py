import bisect
import heapq
import itertools
import operator
import numpy as np
import rospy
from std_msgs.msg import Float64, Float64MultiArray


class Window:
    def __init__(self, n):
        self.buf = np.zeros(n)
        self.ref = np.zeros(n)
        self.heap = []
        self.sorted = []
        self.hist = {}
        self.out = rospy.Publisher("mean", Float64, queue_size=1)
        self.arr = rospy.Publisher("buf", Float64MultiArray, queue_size=1)
        self.oth = rospy.Publisher("ref", Float64MultiArray, queue_size=1)
        self.low = rospy.Publisher("low", Float64, queue_size=1)
        self.med = rospy.Publisher("median", Float64, queue_size=1)
        self.acc = rospy.Publisher("acc", Float64, queue_size=1)
        rospy.Subscriber("x", Float64, self.cb)  # source x
        rospy.Timer(rospy.Duration(1), lambda ev: self.emit())

    def cb(self, m):
        self.buf = np.roll(self.buf, -1)
        self.buf[-1] = m.data
        heapq.heappush(self.heap, (m.data, rospy.get_time()))
        bisect.insort(self.sorted, m.data)
        np.add.at(self.ref, 0, 1.0)
        self.hist[round(m.data)] = self.hist.get(round(m.data), 0) + 1

    def emit(self):
        self.out.publish(np.mean(self.buf))  # sink x
        self.arr.publish(Float64MultiArray(data=self.buf.tolist()))  # sink x
        self.oth.publish(Float64MultiArray(data=self.ref.tolist()))  # clean
        if self.heap:
            value, _ = heapq.heappop(self.heap)
            self.low.publish(value)  # sink x
        self.med.publish(self.sorted[len(self.sorted) // 2])  # sink x
        best = max(self.hist, key=self.hist.get)
        self.acc.publish(best)  # sink x
        self.acc.publish(list(itertools.accumulate(self.sorted, operator.add))[-1])  # sink x
        total = 0.0
        for total in itertools.islice(self.sorted, 3):
            pass
        self.acc.publish(total)  # sink x


rospy.init_node("w")
w = Window(10)
rospy.spin()
