import rospy
from std_msgs.msg import Float64


def limited(value):
    return max(-1.0, min(1.0, value))


def sign(value):
    return 1.0 if value > 0.0 else -1.0


def on_in(msg):
    pub.publish(limited(msg.data))  # sink value
    pub.publish(sign(msg.data))  # sink ~value
    pub.publish(msg.data * 0.0)  # sink value
    pub.publish(type(msg).__name__)  # clean
    pub.publish(isinstance(msg, Float64))  # clean
    pub.publish(rospy.get_time())  # clean


rospy.init_node("sanitized")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, on_in)  # source value
rospy.spin()
