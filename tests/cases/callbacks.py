from functools import partial

import message_filters
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

pub = rospy.Publisher("out", Float64, queue_size=1)


def with_args(msg, name):
    table[name] = msg.data


def swapped(publisher, gain, msg):
    publisher.publish(gain * msg.data)  # sink partial


def on_pair(left, right):
    pub.publish(left.data)  # sink left
    pub.publish(right.data)  # sink right


def make():
    last = [0.0]
    total = 0.0

    def on_nested(msg):
        nonlocal total
        total += msg.data
        last[0] = msg.data

    def on_time(event):
        pub.publish(total)  # sink nested
        pub.publish(last[0])  # sink nested

    return on_nested, on_time


class Handler:
    def __init__(self):
        self.value = 0.0

    def __call__(self, msg):
        pub.publish(msg.data)  # sink object

    def method(self, msg):
        self.value = msg.data

    @staticmethod
    def fixed(msg):
        pub.publish(msg.data)  # sink static


class Base:
    topic = "inherited"

    def start(self):
        self.sub = rospy.Subscriber(self.topic, Float64, self.on_message)  # source inherited
        self.out = rospy.Publisher("result", Float64, queue_size=1)


class Derived(Base):
    def on_message(self, msg):
        self.out.publish(self.convert(msg.data))  # sink inherited

    def convert(self, value):
        return -value


def subscribe(topic, callback):
    return rospy.Subscriber(topic, Float64, callback)


def on_wrapped(msg):
    pub.publish(msg.data)  # sink wrapped


table = {}
handler = Handler()
nested, timed = make()
handlers = {"static": Handler.fixed}
rospy.Subscriber("lambda", Float64, lambda msg: pub.publish(msg.data * 2.0))  # source lambda # sink lambda
rospy.Subscriber("partial", Float64, partial(swapped, pub, 0.5))  # source partial
rospy.Subscriber("a", Float64, with_args, callback_args="a")  # source a
rospy.Subscriber("b", Float64, with_args, "b")  # source b
rospy.Subscriber("nested", Float64, nested)  # source nested
rospy.Timer(rospy.Duration(1.0), timed)
rospy.Subscriber("object", Float64, handler)  # source object
rospy.Subscriber("method", Float64, handler.method)  # source method
rospy.Subscriber("static", Float64, handlers["static"])  # source static
left = message_filters.Subscriber("left", Image)  # source left
right = message_filters.Subscriber("right", Image)  # source right
pair = message_filters.ApproximateTimeSynchronizer([left, right], 10, 0.1)
pair.registerCallback(on_pair)
subscribe("wrapped", on_wrapped)  # source wrapped
Derived().start()

while not rospy.is_shutdown():
    pub.publish(table["a"])  # sink a
    pub.publish(table["b"])  # sink b
    pub.publish(handler.value)  # sink method
    answer = rospy.wait_for_message("once", Float64)  # source once
    pub.publish(answer.data)  # sink once
    rospy.sleep(0.1)
