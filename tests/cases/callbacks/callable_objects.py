import rospy
from std_msgs.msg import Float64


class LowPass:
    def __init__(self, alpha, sink=None):
        self.alpha = alpha
        self.value = 0.0
        self.sink = sink

    def __call__(self, msg):
        self.value = self.alpha * msg.data + (1.0 - self.alpha) * self.value
        if self.sink:
            self.sink(self.value)


def emit(value):
    pub.publish(value)  # sink chained


rospy.init_node("lowpass")
pub = rospy.Publisher("out", Float64, queue_size=1)
slow = LowPass(0.1)
fast = LowPass(0.9)
chained = LowPass(0.5, emit)
rospy.Subscriber("raw", Float64, slow)  # source raw
rospy.Subscriber("chained", Float64, chained)  # source chained
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    pub.publish(slow.value)  # sink raw
    pub.publish(slow.alpha)  # clean
    pub.publish(fast.value)  # clean
    rate.sleep()
