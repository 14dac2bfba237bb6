import rospy
from std_msgs.msg import Float64

from wheel_driver.filters.smooth import Smooth
from .msgs import number


class Driver:
    def __init__(self):
        self.smooth = Smooth(0.5)
        self.pub = rospy.Publisher("out", Float64, queue_size=1)

    def start(self):
        rospy.Subscriber("in", Float64, self.on_in)  # source value

    def on_in(self, msg):
        self.pub.publish(number(self.smooth.add(msg.data)))  # sink value
        self.pub.publish(number(self.smooth.gain))  # clean
