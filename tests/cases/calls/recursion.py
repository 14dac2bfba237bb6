import rospy
from std_msgs.msg import Float64, Float64MultiArray


def total(values):
    if not values:
        return 0.0
    return values[0] + total(values[1:])


def depth(n, limit):
    return limit if n == 0 else depth(n - 1, limit)


def even(value, n):
    return value if n == 0 else odd(value, n - 1)


def odd(value, n):
    return 0.0 if n == 0 else even(value, n - 1)


class Tree:
    def __init__(self, value, children=()):
        self.value = value
        self.children = children

    def sum(self):
        return self.value + sum(child.sum() for child in self.children)


def on_in(msg):
    pub.publish(total(list(msg.data)))  # sink value
    pub.publish(total([1.0, 2.0]))  # clean
    pub.publish(depth(3, 1.0))  # clean
    pub.publish(even(msg.data[0], 4))  # sink value
    pub.publish(even(2.0, 4))  # clean
    pub.publish(Tree(1.0, [Tree(msg.data[0])]).sum())  # sink value
    pub.publish(Tree(1.0, [Tree(2.0)]).sum())  # clean


rospy.init_node("recursion")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64MultiArray, on_in)  # source value
rospy.spin()
