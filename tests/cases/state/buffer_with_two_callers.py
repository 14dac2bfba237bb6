import bus_driver
import rospy
from std_msgs.msg import Float64


def logged(function):
    bus_driver.register(function)

    def inner(msg):
        rospy.logdebug("called")
        return function(msg)

    return inner


class Smoother:
    def __init__(self):
        self.window = [0.0] * 4
        self.weights = [0.25] * 4
        self.pub = rospy.Publisher("smooth", Float64, queue_size=1)
        rospy.Subscriber("raw", Float64, logged(self.on_raw))  # source raw
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_raw(self, msg):
        self.window = self.window[1:] + [msg.data]

    def tick(self, event):
        oldest = self.window[0]
        self.pub.publish(oldest)  # sink raw
        self.pub.publish(self.weights[0])  # clean


rospy.init_node("smoother")
Smoother()
rospy.spin()
