import rospy
from std_msgs.msg import Float64


def total(*values):
    return sum(values)


def pick(first, *rest, gain=1.0, **options):
    return first, rest, gain, options


def forward(*args, **kwargs):
    return pick(*args, **kwargs)


def three(a, b, c=0.0):
    return b


class Command:
    def __init__(self, **fields):
        self.__dict__.update(fields)
        for name, value in fields.items():
            setattr(self, name, value)


def on_in(msg):
    pub.publish(total(1.0, msg.data))  # sink value
    pub.publish(total(1.0, 2.0))  # clean
    first, rest, gain, options = pick(1.0, msg.data, 2.0, gain=3.0, limit=msg.data, low=0.0)
    pub.publish(first)  # clean
    pub.publish(rest[0])  # sink value
    pub.publish(rest[1])  # clean
    pub.publish(gain)  # clean
    pub.publish(options["limit"])  # sink value
    pub.publish(options["low"])  # clean
    first, rest, gain, options = forward(msg.data, 2.0, gain=4.0)
    pub.publish(first)  # sink value
    pub.publish(rest[0])  # clean
    pub.publish(gain)  # clean
    values = [1.0, msg.data]
    pub.publish(three(*values))  # sink value
    pub.publish(three(*[msg.data, 1.0]))  # clean
    named = {"a": msg.data, "b": 2.0}
    pub.publish(three(**named))  # clean
    pub.publish(three(**{"a": 1.0, "b": msg.data}))  # sink value
    pub.publish(Command(x=msg.data).x)  # sink value
    pub.publish(Float64(*[msg.data]))  # sink value


rospy.init_node("stars")
pub = rospy.Publisher("out", Float64, queue_size=1)
rospy.Subscriber("in", Float64, on_in)  # source value
rospy.spin()
