import asyncio
import functools

import rospy
from std_msgs.msg import Float64


def traced(function):
    @functools.wraps(function)
    def inner(*args, **kwargs):
        rospy.loginfo(function.__name__)
        return function(*args, **kwargs)

    return inner


@traced
def decorated(msg):
    pub.publish(msg.data)  # sink decorated


def collect(*values, **named):
    return values[0], values[1], named["gain"]


def apply(function, value):
    return function(value)


def count(limit, start=0.0):
    value = start
    for _ in range(3):
        yield value
        value += limit


class Shape:
    def area(self):
        return 1.0


class Square(Shape):
    def __init__(self, side):
        self.side = side

    def area(self):
        return self.side * super().area()

    @classmethod
    def of(cls, side):
        return cls(side)

    @staticmethod
    def twice(value):
        return 2 * value


def on_input(msg):
    first, second, gain = collect(msg.data, 2.0, gain=3.0)
    pub.publish(first)  # sink in
    pub.publish(second)  # clean
    pub.publish(gain)  # clean
    pub.publish(apply(lambda x: x + 1, msg.data))  # sink in
    pub.publish(apply(lambda x: x + 1, 4.0))  # clean
    pub.publish(list(count(msg.data))[0])  # sink in
    pub.publish(sum(count(1.0)))  # clean
    shape = Square(msg.data)
    pub.publish(shape.area())  # sink in
    pub.publish(Shape().area())  # clean
    pub.publish(Square.of(msg.data).side)  # sink in
    pub.publish(Square.twice(msg.data))  # sink in
    pub.publish(max(map(abs, [msg.data, 1.0])))  # sink in
    options = {"a": msg.data, "b": 1.0}
    pub.publish(Float64(**options))  # sink in
    best = sorted([(msg.data, "x")], key=lambda item: item[0])[0]
    pub.publish(best[0])  # sink in
    try:
        value = float(msg.data)
    except ValueError:
        value = 0.0
    finally:
        rospy.loginfo("done")
    pub.publish(value)  # sink in
    result = None
    while result is None:
        result = msg.data
    pub.publish(result)  # sink in
    asyncio.run(later(msg.data))
    for pair in zip([msg.data], [1.0]):
        pub.publish(pair[0])  # sink in
        pub.publish(pair[1])  # clean


async def later(value):
    await asyncio.sleep(1)
    pub.publish(value)  # sink in


pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("decorated", Float64, decorated)  # source decorated
rospy.Subscriber("in", Float64, on_input)  # source in
rospy.spin()
