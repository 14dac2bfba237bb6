"""A counter that a message may reset: the analysis covers all values that it can reach by counting."""

import rospy
from std_msgs.msg import Bool, Float64, Int32

turns = 0
ticks = 0


class Ring:
    def __init__(self):
        self.index = 0
        self.full = False
        self.half = False

    def push(self):
        self.index = (self.index + 1) % 5
        self.half = self.index == 2
        if self.index == 0:
            self.full = True

    def clear(self):
        self.index = 0


def on_level(msg):
    global turns, ticks
    ring.push()
    ticks = ticks + 1
    turns = turns + 1
    if turns > 4:
        late.publish(msg)  # sink level ~reset
    if ticks > 4:
        late.publish(True)  # clean
    count.publish(turns)  # sink ~reset
    count.publish(ticks)  # clean


def on_reset(msg):
    global turns, ticks
    ticks = 0
    if msg.data:
        turns = 0
        ring.clear()


def tell(_):
    flag.publish(ring.full)  # sink ~reset
    flag.publish(ring.half)  # sink ~reset
    count.publish(ticks)  # clean


rospy.init_node("counter")
ring = Ring()
late = rospy.Publisher("late", Float64, queue_size=1)
count = rospy.Publisher("count", Int32, queue_size=1)
flag = rospy.Publisher("flag", Bool, queue_size=1)
rospy.Subscriber("level", Float64, on_level)  # source level
rospy.Subscriber("reset", Bool, on_reset)  # source reset
rospy.Timer(rospy.Duration(1), tell)
rospy.spin()
