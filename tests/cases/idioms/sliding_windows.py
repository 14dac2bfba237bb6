"""Deques with a maximal length, `statistics`, named tuples, heaps and bisection over stamps."""

import bisect
import heapq
import statistics
from collections import Counter, deque, namedtuple

import rospy
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import Temperature
from std_msgs.msg import Float64, String

Sample = namedtuple("Sample", "stamp value")


class Windows:
    __slots__ = ("buffer", "hot", "heap", "stamps", "names", "pubs")

    def __init__(self):
        self.buffer = deque(maxlen=20)
        self.hot = deque([0.0] * 3, 3)
        self.heap = []
        self.stamps = []
        self.names = Counter()
        self.pubs = {k: rospy.Publisher(k, Float64, queue_size=1) for k in ("mean", "last", "worst", "size")}
        self.pubs["name"] = rospy.Publisher("name", String, queue_size=1)
        rospy.Subscriber("temperature", Temperature, self.on_temperature)  # source temperature
        rospy.Subscriber("pose", PoseStamped, self.on_pose)  # source pose
        rospy.Timer(rospy.Duration(1), self.on_timer)

    def on_temperature(self, msg):
        self.buffer.append(Sample(msg.header.stamp.to_sec(), msg.temperature))
        heapq.heappush(self.heap, (-msg.temperature, len(self.buffer)))
        self.hot.appendleft(msg.variance)

    def on_pose(self, msg):
        self.names[msg.header.frame_id] += 1
        bisect.insort(self.stamps, msg.header.stamp.to_sec())

    def on_timer(self, _):
        if len(self.buffer) < self.buffer.maxlen:
            self.pubs["size"].publish(len(self.buffer))  # clean
            return
        self.pubs["mean"].publish(statistics.mean(s.value for s in self.buffer))  # sink temperature
        newest = self.buffer[-1]
        self.pubs["last"].publish(newest.stamp)  # sink temperature
        self.pubs["last"].publish(sum(self.hot) / len(self.hot))  # sink temperature
        worst, _ = heapq.heappop(self.heap)
        self.pubs["worst"].publish(-worst)  # sink temperature
        index = bisect.bisect(self.stamps, rospy.get_time() - 1.0)
        self.pubs["size"].publish(index)  # sink pose
        (name, count), *_ = self.names.most_common(1)
        self.pubs["name"].publish(name)  # sink pose
        self.pubs["size"].publish(self.buffer.maxlen)  # clean


if __name__ == "__main__":
    rospy.init_node("windows")
    Windows()
    rospy.spin()
