"""Elements that are known one by one stay separate in zip, enumerate, map and comprehensions."""

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Float64


def half(x):
    return x / 2


def on_point(msg):
    (_, a), (_, b) = [(g, v) for g, v in zip((1.0, 2.0), (msg.x, 5.0))]
    out.publish(a)  # sink point
    out.publish(b)  # clean
    for _, v in zip(("p", "q"), (msg.x, 5.0)):
        out.publish(v)  # sink point
    x, y = map(half, (msg.x, 4.0))
    out.publish(x)  # sink point
    out.publish(y)  # clean
    pairs = list(zip([msg.x, 1.0], [2.0, 3.0]))
    out.publish(pairs[0][0])  # sink point
    out.publish(pairs[0][1])  # clean
    out.publish(pairs[1][0])  # clean
    for i, _ in enumerate([msg.x, 2.0]):
        out.publish(i)  # clean
    numbered = list(enumerate([msg.x, 2.0]))
    out.publish(numbered[0][1])  # sink point
    out.publish(numbered[1][1])  # clean
    named = dict(zip(("a", "b"), (msg.x, 1.0)))
    out.publish(named["a"])  # sink point
    out.publish(named["b"])  # clean
    left, right = [float(v) for v in (msg.x, 3.0)]
    out.publish(left)  # sink point
    out.publish(right)  # clean
    out.publish(sum(v for v in (msg.x, 3.0)))  # sink point
    out.publish(max(map(half, msg.z)))  # sink point


out = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("point", Point, on_point)  # source point
rospy.spin()
