import asyncio
import time
import threading
import rospy
from std_msgs.msg import Float64, Bool


class Atomic:
    def __init__(self):
        self.tmp = 0.0
        self.open = 0.0
        self.late = 0.0
        self.busy = False
        self.pub = rospy.Publisher("p", Float64, queue_size=1)
        self.flag = rospy.Publisher("f", Bool, queue_size=1)
        rospy.Subscriber("a", Float64, self.on_a)  # source a
        rospy.Subscriber("b", Float64, self.on_b)  # source b
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_a(self, msg):
        self.busy = True
        self.tmp = msg.data
        self.pub.publish(self.tmp)  # sink a
        self.tmp = 0.0
        self.open = msg.data
        rospy.sleep(0.1)
        self.open = 0.0
        self.busy = False

    def on_b(self, msg):
        self.late = msg.data
        before = self.late
        self.wait()
        self.pub.publish(before)  # sink b
        self.late = 1.0

    def wait(self):
        time.sleep(0.5)

    def tick(self, _):
        self.pub.publish(self.tmp)  # clean
        self.pub.publish(self.open)  # sink a
        self.pub.publish(self.late)  # sink b
        self.flag.publish(self.busy)  # clean


rospy.init_node("a")
Atomic()
rospy.spin()
