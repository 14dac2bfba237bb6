"""Whether a message has arrived is not its data, even if an object of the node stores the message."""

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Bool, Float64


class Filter:
    def __init__(self):
        self.time = None
        self.mean = 0.0

    def feed(self, value):
        self.mean += 0.1 * (value - self.mean)


class Node:
    def __init__(self):
        self.filter = Filter()
        self.out = rospy.Publisher("mean", Float64, queue_size=1)
        self.alive = rospy.Publisher("alive", Bool, queue_size=1)
        self.fast = rospy.Publisher("fast", Bool, queue_size=1)
        rospy.Subscriber("odom", Odometry, self.on_odom)  # source odom

    def on_odom(self, msg):
        now = msg.header.stamp.to_sec()
        if self.filter.time is None:
            self.filter.time = now
            return
        self.filter.time = now
        self.filter.feed(msg.twist.twist.linear.x)
        self.alive.publish(True)  # clean
        self.out.publish(self.filter.mean)  # sink odom
        if self.filter.time > 100.0:
            self.fast.publish(True)  # sink ~odom


rospy.init_node("node")
Node()
rospy.spin()
