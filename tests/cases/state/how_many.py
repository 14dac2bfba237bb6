"""The data in the length of a container passes through every statement that builds the container."""

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Int32


class Counter:
    def __init__(self):
        self.points = []
        self.fixed = [1.0, 2.0]
        self.all = rospy.Publisher("all", Int32, queue_size=1)
        self.near = rospy.Publisher("near", Int32, queue_size=1)
        self.rest = rospy.Publisher("rest", Int32, queue_size=1)
        self.two = rospy.Publisher("two", Int32, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.on_scan)  # source scan

    def close(self, points):
        found = [p for p in points if p < 1.0]  # step scan
        return found  # step scan

    def on_scan(self, msg):
        values = [float(r) for r in msg.ranges]  # step scan
        self.points = list(values)  # step scan
        near = self.close(self.points)  # step scan
        self.near.publish(len(near))  # sink scan
        count = len(self.points)  # step scan
        self.all.publish(count)  # sink scan
        zeros = [0] * count  # step scan
        rest = zeros[1:]  # step scan
        self.rest.publish(len(rest))  # sink scan
        self.two.publish(len(self.fixed))  # clean


rospy.init_node("counter")
Counter()
rospy.spin()
