import threading
import time
import copy
from concurrent.futures import ThreadPoolExecutor, Future
from collections import OrderedDict, ChainMap, Counter, defaultdict, deque
import rospy
from std_msgs.msg import Float64, Float32, String
from sensor_msgs.msg import LaserScan


class Worker:
    def __init__(self):
        self.pool = ThreadPoolExecutor(2)
        self.results = deque(maxlen=10)
        self.cond = threading.Condition()
        self.level = None
        self.pending = Future()
        self.chain = ChainMap({}, {"gain": 2.0})
        self.counts = Counter()
        self.groups = defaultdict(list)
        self.pub = rospy.Publisher("o", Float64, queue_size=1)
        self.pub2 = rospy.Publisher("o2", Float64, queue_size=1)
        self.pub3 = rospy.Publisher("o3", Float64, queue_size=1)
        self.pub4 = rospy.Publisher("o4", Float64, queue_size=1)
        rospy.Subscriber("in", Float64, self.results.append)  # source direct
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Subscriber("f", Float64, self.on_future)  # source fut
        threading.Thread(target=self.loop, kwargs={"gain": 2.0}, daemon=True).start()
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_scan(self, msg):
        fut = self.pool.submit(self.heavy, msg.ranges, scale=2)
        fut.add_done_callback(lambda f: self.pub.publish(f.result()))  # sink scan
        with self.cond:
            self.level = min(msg.ranges)
            self.cond.notify_all()
        for i, r in enumerate(msg.ranges):
            self.groups[i // 10].append(r)
        self.counts["scans"] += 1
        self.chain["last"] = msg.range_max

    def heavy(self, ranges, scale):
        total = 0
        for r in ranges:
            total += r * scale
        return total

    def on_future(self, msg):
        if not self.pending.done():
            self.pending.set_result(msg.data)

    def loop(self, gain):
        while not rospy.is_shutdown():
            with self.cond:
                self.cond.wait_for(lambda: self.level is not None)
                level = self.level
            self.pub2.publish(gain * level)  # sink scan
            self.pub2.publish(gain)  # clean
            self.pub3.publish(self.pending.result(timeout=1.0))  # sink fut

    def tick(self, _):
        for msg in list(self.results):
            self.pub4.publish(msg.data)  # sink direct
        self.pub4.publish(self.chain["last"])  # sink scan
        self.pub4.publish(self.chain["gain"])  # clean
        self.pub4.publish(self.counts["scans"])  # clean
        for key, values in sorted(self.groups.items()):
            self.pub4.publish(sum(values))  # sink scan


rospy.init_node("w")
w = Worker()
rospy.spin()
