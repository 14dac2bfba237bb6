import numpy as np
import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64


class Starting:
    area = None

    def __init__(self):
        self.front = None
        self.ends = None
        self.beams = None
        self.target = None
        self.ready = rospy.Publisher("ready", Bool, queue_size=1)
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan, queue_size=1)  # source scan
        rospy.Timer(rospy.Duration(0.1), self.step)

    def on_scan(self, scan):
        self.front = min(scan.ranges)
        self.ends = (scan.ranges[0], scan.ranges[-1])
        self.beams = np.array(scan.ranges)
        self.area = scan.range_max
        self.target = scan.range_min if self.front < 2.0 else None

    def first_below(self, limit):
        found = None
        for number, beam in enumerate(self.beams):
            if beam < limit:
                found = number
                break
        return -1 if found is None else 1

    def step(self, _event):
        if self.front is None or self.ends is None:
            self.ready.publish(False)  # clean
            return
        self.ready.publish(self.beams is not None)  # clean
        if self.area == None:  # noqa: E711
            return
        self.ready.publish(True)  # clean
        if self.target is not None:
            self.ready.publish(True)  # sink ~scan
        self.out.publish(self.first_below(0.5))  # sink ~scan
        self.out.publish(self.front)  # sink scan


rospy.init_node("starting")
Starting()
rospy.spin()
