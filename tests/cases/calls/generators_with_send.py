import functools
import rospy
from std_msgs.msg import Float32


def low_pass(alpha):
    state = 0.0
    while True:
        sample = yield state
        state = alpha * sample + (1 - alpha) * state


def primed(gen):
    @functools.wraps(gen)
    def start(*args, **kwargs):
        g = gen(*args, **kwargs)
        next(g)
        return g
    return start


@primed
def counter():
    n = 0
    while True:
        yield n
        n += 1


class Filter:
    def __init__(self):
        self.filter = low_pass(0.3)
        next(self.filter)
        self.counter = counter()
        self.pub = rospy.Publisher("out", Float32, queue_size=1)
        self.count = rospy.Publisher("count", Float32, queue_size=1)
        self.sub = rospy.Subscriber("in", Float32, self.cb)  # source x

    def cb(self, msg):
        out = self.filter.send(msg.data)
        self.pub.publish(out)  # sink x
        self.count.publish(next(self.counter))  # clean


rospy.init_node("f")
f = Filter()
rospy.spin()
