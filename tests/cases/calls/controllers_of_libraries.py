"""Methods of a library's objects return results, also those with the names of methods that change containers."""

import rospy
from std_msgs.msg import Float64

import pid_library
import tracker_library


class Driver:
    def __init__(self, tracker):
        self.controller = pid_library.Controller(kp=0.8)
        self.tracker = tracker
        self.seen = {}
        self.out = rospy.Publisher("speed", Float64, queue_size=1)
        rospy.Subscriber("distance", Float64, self.on_distance)  # source distance
        rospy.Subscriber("angle", Float64, self.on_angle)  # source angle
        rospy.Subscriber("label", Float64, self.on_label)  # source label

    def on_distance(self, msg):
        self.out.publish(self.controller.update(1.0 - msg.data))  # sink distance

    def on_angle(self, msg):
        boxes = self.tracker.add(msg.data)
        self.out.publish(boxes[0])  # sink angle label

    def on_label(self, msg):
        self.out.publish(self.seen.update(label=msg.data))  # clean
        self.tracker.update(msg.data)


rospy.init_node("driver")
Driver(tracker_library.Tracker(30))
rospy.spin()
