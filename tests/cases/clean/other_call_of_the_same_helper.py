import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64


def limit(value, low=-1.0, high=1.0):
    if value < low:
        return low
    return high if value > high else value


def make(x, z=0.0):
    cmd = Twist()
    cmd.linear.x = x
    cmd.angular.z = z
    return cmd


def fill(target, value):
    target.linear.x = value


def emit(pub, value):
    pub.publish(limit(value))  # sink speed


def emit_fixed(pub, value):
    pub.publish(limit(value))  # clean


def on_speed(msg):
    num.publish(limit(msg.data))  # sink speed
    num.publish(limit(2.0))  # clean
    pub.publish(make(msg.data))  # sink speed
    pub.publish(make(0.1, 0.2))  # clean
    first, second = Twist(), Twist()
    fill(first, msg.data)
    fill(second, 0.5)
    pub.publish(first)  # sink speed
    pub.publish(second)  # clean
    emit(num, msg.data)
    emit_fixed(num, 0.7)
    for value in (msg.data, 1.0):
        num.publish(limit(value))  # sink speed
    for value in (2.0, 1.0):
        num.publish(limit(value))  # clean


rospy.init_node("helper")
num = rospy.Publisher("num", Float64, queue_size=1)
pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
rospy.Subscriber("speed", Float64, on_speed)  # source speed
rospy.spin()
