import functools
from functools import partial

import rospy
from std_msgs.msg import Float64


class Bank:
    def __init__(self):
        self.values = [0.0, 0.0]
        self.pub = rospy.Publisher("out", Float64, queue_size=1)
        rospy.Subscriber("zero", Float64, functools.partial(self.keep, 0))  # source zero
        rospy.Subscriber("one", Float64, partial(self.keep, index=1))  # source one
        rospy.Subscriber("scaled", Float64, partial(publish_scaled, self.pub, factor=2.0))  # source scaled
        send = partial(self.send, 5.0)
        rospy.Timer(rospy.Duration(1), lambda event: send(self.values[0]))

    def keep(self, first, second=None, index=None):
        msg = first if second is None else second
        if index is None:
            self.values[0] = msg.data
        else:
            self.values[1] = msg.data

    def send(self, limit, value):
        self.pub.publish(value)  # sink zero
        self.pub.publish(limit)  # clean


def publish_scaled(pub, msg, factor=1.0):
    pub.publish(msg.data * factor)  # sink scaled
    pub.publish(factor)  # clean


rospy.init_node("bank")
Bank()
rospy.spin()
