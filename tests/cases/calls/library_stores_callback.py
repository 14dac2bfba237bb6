import queue

import markers
import rospy
from std_msgs.msg import Float64


class Handle:
    def __init__(self):
        self.odom = None
        self.goal = None
        self.waiting = queue.Queue()
        self.kept = []
        self.never = None
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        self.server = markers.Server("handle")
        rospy.Subscriber("odom", Float64, self.on_odom)  # source odom
        self.server.insert("goal", feedback_callback=self.on_feedback)
        self.server.add(self.on_click)
        self.waiting.put(self.on_nothing)
        self.kept.append(self.on_nothing)
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_odom(self, msg):
        self.odom = msg.data

    def on_feedback(self, feedback):
        self.goal = feedback.x

    def on_click(self):
        self.pub.publish(self.odom)  # sink odom

    def on_nothing(self):
        self.never = 1.0

    def tick(self, event):
        if self.goal is not None:
            self.pub.publish(self.odom - self.goal)  # sink odom
        if self.never is not None:
            self.pub.publish(self.odom)  # clean


rospy.init_node("handle")
Handle()
rospy.spin()
