"""Functions that iterate over their arguments call `__iter__` of objects of the program."""

import rospy
from std_msgs.msg import Float32, Float32MultiArray, Int32


class Ring:
    def __init__(self, size):
        self.data = [0.0] * size
        self.index = 0

    def push(self, value):
        self.data[self.index] = value  # step level
        self.index = (self.index + 1) % len(self.data)

    def __iter__(self):
        for place in range(len(self.data)):
            yield self.data[place]  # step level


class Places:
    def __init__(self, ring):
        self.ring = ring

    def __iter__(self):
        return iter(range(len(self.ring.data)))


def on_level(msg):
    ring.push(msg.data)  # step level
    ordered = sorted(ring)  # step level
    out.publish(ordered[0])  # sink level
    out.publish(max(ring))  # sink level
    out.publish(sum(ring))  # sink level
    several.publish(data=list(ring))  # sink level
    for _, value in enumerate(ring):  # step level
        out.publish(value)  # sink level
    count.publish(sum(places))  # clean


rospy.init_node("ring")
ring = Ring(5)
places = Places(ring)
out = rospy.Publisher("out", Float32, queue_size=1)
several = rospy.Publisher("several", Float32MultiArray, queue_size=1)
count = rospy.Publisher("count", Int32, queue_size=1)
rospy.Subscriber("level", Float32, on_level)  # source level
rospy.spin()
