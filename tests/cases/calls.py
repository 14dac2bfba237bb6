import rospy
from geometry_msgs.msg import Twist, Vector3
from std_msgs.msg import Float64


def scaled(value, factor=2.0):
    return value * factor


def build(x, z):
    cmd = Twist()
    cmd.linear.x = x
    cmd.angular.z = z
    return cmd


def both(a, b):
    return a, b


def send(publisher, value):
    publisher.publish(value)  # sink in


def send_quietly(publisher, value):
    publisher.publish(value)  # clean


class Filter:
    def __init__(self):
        self.last = 0.0

    def update(self, value):
        self.last = 0.8 * self.last + 0.2 * value
        return self.last

    def reset(self):
        self.last = 0.0
        return self.last


smooth = Filter()
other = Filter()


def on_input(msg):
    value = scaled(msg.data)
    pub.publish(value)  # sink in
    constant = scaled(3.0)
    pub.publish(constant)  # clean
    cmd = build(msg.data, 0.1)
    pub.publish(cmd.linear.x)  # sink in
    pub.publish(cmd.angular.z)  # clean
    twist.publish(cmd)  # sink in
    still = build(0.0, 0.1)
    twist.publish(still)  # clean
    first, second = both(msg.data, 1.0)
    pub.publish(first)  # sink in
    pub.publish(second)  # clean
    send(pub, value)
    send_quietly(pub, constant)
    pub.publish(smooth.update(value))  # sink in
    pub.publish(other.update(1.0))  # clean
    pub.publish(smooth.reset())  # clean
    twist.publish(Twist(linear=Vector3(x=value), angular=Vector3()))  # sink in
    twist.publish(Twist(angular=Vector3(z=0.2)))  # clean
    rospy.Publisher("late", Float64, queue_size=1).publish(value)  # sink in
    pub.publish(recursive(msg.data, 3))  # sink in


def recursive(value, depth):
    if depth == 0:
        return value
    return recursive(value, depth - 1)


pub = rospy.Publisher("out", Float64, queue_size=1)
twist = rospy.Publisher("twist", Twist, queue_size=1)
rospy.Subscriber("in", Float64, on_input)  # source in
rospy.spin()
