"""A `finally` runs whichever way its `try` ends, so no condition in the `try` decides on it, only on later code."""

import rospy
from std_msgs.msg import Float32, Int32


def parse(x):
    if x > 3:
        raise ValueError("x")
    return x


def on_early(m):
    try:
        if m.data > 5:
            return
        out.publish(1)  # sink ~early
    finally:
        out.publish(2)  # clean
        if m.data > 9:
            out.publish(3)  # sink ~early
    out.publish(4)  # sink ~early


def on_wrong(m):
    try:
        y = parse(m.data)
    except ValueError:
        out.publish(1)  # sink ~wrong
        return
    finally:
        out.publish(2)  # clean
    out.publish(y)  # sink wrong


def on_turns(m):
    for _ in range(5):
        try:
            if m.data > 5:
                continue
            out.publish(1)  # sink ~turns
        finally:
            out.publish(2)  # clean
    for _ in range(5):
        try:
            if m.data > 7:
                break
        finally:
            out.publish(3)  # sink ~turns


def on_inner(m):
    if m.data > 3:
        try:
            out.publish(1)  # sink ~inner
        finally:
            out.publish(2)  # sink ~inner
    try:
        try:
            if m.data > 6:
                return
        finally:
            out.publish(3)  # clean
    finally:
        out.publish(4)  # clean


def on_result(m):
    try:
        return parse(m.data)
    finally:
        out.publish(2)  # clean


rospy.init_node("whatever")
out = rospy.Publisher("out", Int32, queue_size=1)
rospy.Subscriber("early", Float32, on_early)  # source early
rospy.Subscriber("wrong", Float32, on_wrong)  # source wrong
rospy.Subscriber("turns", Float32, on_turns)  # source turns
rospy.Subscriber("inner", Float32, on_inner)  # source inner
rospy.Subscriber("result", Float32, on_result)  # source result
rospy.spin()
