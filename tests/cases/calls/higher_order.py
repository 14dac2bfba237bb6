import functools
import operator

import rospy
from std_msgs.msg import Float64, Float64MultiArray


def apply(function, *args):
    return function(*args)


def compose(*functions):
    def composed(value):
        for function in functions:
            value = function(value)
        return value

    return composed


def constant(value):
    return lambda _: value


class Pipeline:
    def __init__(self):
        self.stages = []

    def add(self, stage):
        self.stages.append(stage)
        return self

    def run(self, value):
        for stage in self.stages:
            value = stage(value)
        return value


double = functools.partial(operator.mul, 2.0)
pipeline = Pipeline().add(abs).add(lambda x: x + 1.0)
handlers = {"double": lambda x: 2 * x, "none": lambda x: 0.0}


def on_in(msg):
    value = msg.data[0]
    pub.publish(apply(lambda a, b: a, value, 1.0))  # sink value
    pub.publish(apply(lambda a, b: b, value, 1.0))  # clean
    pub.publish(compose(abs, lambda x: x / 2.0)(value))  # sink value
    pub.publish(constant(3.0)(value))  # clean
    pub.publish(constant(value)(3.0))  # sink value
    pub.publish(pipeline.run(value))  # sink value
    pub.publish(double(value))  # sink value
    pub.publish(double(1.0))  # clean
    pub.publish(handlers["double"](value))  # sink value
    pub.publish(handlers["none"](value))  # clean
    pub.publish(functools.reduce(lambda a, b: a + b, msg.data, 0.0))  # sink value
    pub.publish(max(msg.data, key=lambda x: -x))  # sink value
    pub.publish(list(map(float, ["1.0"]))[0])  # clean
    pub.publish(sorted([1.0, 2.0], key=lambda x: -x)[0])  # clean
    pub.publish(next(filter(lambda x: x > 0.0, msg.data)))  # sink value


rospy.init_node("higher")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64MultiArray, on_in)  # source value
rospy.spin()
