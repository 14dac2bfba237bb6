"""A panel that a framework creates; its base class is not in the files, and a helper registers its callbacks."""

import rospy
from std_msgs.msg import Float64


def listen(topic, function):
    return rospy.Subscriber(topic, Float64, function)


class Panel:
    def __init__(self, context):
        self.level = 0.0
        self.out = rospy.Publisher("level", Float64, queue_size=1)
        listen("gauge", self.on_gauge)  # source gauge

    def on_gauge(self, msg):
        self.level = msg.data

    def shutdown_plugin(self):
        self.out.publish(self.level)  # sink gauge
        self.out.publish(0.0)  # clean
