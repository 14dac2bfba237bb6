"""Functions have attributes: state, and other functions."""

import rospy
from std_msgs.msg import Bool, Float32, Int32


def make_mean(weight):
    value = None

    def step(x, last=0.0):
        nonlocal value
        value = x if value is None else weight * x + (1 - weight) * value
        return value - last

    def peek():
        return value

    step.peek = peek
    step.weight = weight
    step.last = value
    return step


def tell(_):
    out.publish(tell.level)  # sink level
    out.publish(tell.scale)  # clean
    tell.turns += 1
    count.publish(tell.turns)  # clean
    out.publish(other.level)  # clean
    out.publish(mean.peek())  # sink level
    out.publish(calm.peek())  # clean
    out.publish(mean.weight)  # clean
    if tell.high:
        flag.publish(True)  # sink ~level


def other(_):
    other.level = 1.0


def on_level(msg):
    tell.level = msg.data
    tell.high = msg.data > 3.0
    out.publish(mean(msg.data))  # sink level
    out.publish(calm(5.0))  # clean


tell.level = 0.0
tell.high = False
tell.scale = 2.0
tell.turns = 0
other.level = 0.0
mean = make_mean(0.2)
calm = make_mean(0.1)
rospy.init_node("functions")
out = rospy.Publisher("out", Float32, queue_size=1)
count = rospy.Publisher("count", Int32, queue_size=1)
flag = rospy.Publisher("flag", Bool, queue_size=1)
rospy.Subscriber("level", Float32, on_level)  # source level
rospy.Timer(rospy.Duration(1.0), tell)
rospy.Timer(rospy.Duration(1.0), other)
rospy.spin()
