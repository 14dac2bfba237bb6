"""A variable that can only hold an instance of a class is never None."""

import rospy
from std_msgs.msg import Float64


class Buffer:
    def __init__(self, topic):
        self.value = 0.0
        rospy.Subscriber(topic, Float64, self.on_value)  # source value

    def on_value(self, msg):
        self.value = msg.data

    @staticmethod
    def made(topic):
        return Buffer(topic)


class Filter:
    def __init__(self, buffer=None, spare=None):
        if buffer is None:
            self.buffer = Other()
        else:
            self.buffer = buffer
        self.spare = spare if spare is not None else Other()
        self.out = rospy.Publisher("out", Float64, queue_size=1)
        self.more = rospy.Publisher("more", Float64, queue_size=1)
        rospy.Timer(rospy.Duration(0.1), self.step)

    def step(self, event):
        self.out.publish(self.buffer.value)  # sink value
        self.more.publish(self.spare.value)  # sink other


class Other:
    def __init__(self):
        self.value = 0.0
        rospy.Subscriber("other", Float64, self.on_value)  # source other

    def on_value(self, msg):
        self.value = msg.data


class Fixed(Filter):
    def __init__(self):
        super().__init__(buffer=Buffer.made("value"))


class Chosen:
    def __init__(self):
        self.held = None
        self.out = rospy.Publisher("chosen", Float64, queue_size=1)
        rospy.Subscriber("choice", Float64, self.on_choice)  # source choice

    def on_choice(self, msg):
        self.held = Constant() if msg.data > 0.5 else None
        if self.held is None:
            self.out.publish(0.0)  # sink ~choice
        Constant().tell()


class Constant:
    value = 1.0

    def __init__(self):
        self.out = rospy.Publisher("constant", Float64, queue_size=1)

    def tell(self):
        self.out.publish(Constant.value)  # clean


rospy.init_node("filter")
Fixed()
Chosen()
rospy.spin()
