import time

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64, Int32


class Watchdog:
    def __init__(self):
        self.last = None
        self.time = rospy.Time.now()
        self.count = 0
        self.got = False
        self.stamps = []
        self.alive = rospy.Publisher("alive", Bool, queue_size=1)
        self.num = rospy.Publisher("count", Int32, queue_size=1)
        self.age = rospy.Publisher("age", Float64, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan
        rospy.Timer(rospy.Duration(1), self.tick)

    def on_scan(self, msg):
        self.last = msg
        self.time = rospy.Time.now()
        self.got = True
        self.count += 1
        self.stamps.append(time.time())
        self.alive.publish(True)  # clean

    def tick(self, event):
        self.alive.publish(self.got)  # clean
        self.num.publish(self.count)  # clean
        self.age.publish((rospy.Time.now() - self.time).to_sec())  # clean
        if self.last is None:
            self.alive.publish(False)  # clean
            return
        if len(self.stamps) > 2:
            self.age.publish(self.stamps[-1] - self.stamps[-2])  # clean
        self.age.publish(self.last.ranges[0])  # sink scan
        if self.last:
            self.alive.publish(True)  # clean
        if not self.last.ranges:
            self.alive.publish(False)  # sink ~scan


rospy.init_node("watchdog")
Watchdog()
rospy.spin()
