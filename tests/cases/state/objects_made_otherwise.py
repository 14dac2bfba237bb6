import functools
import attr
import rospy
from dataclasses import dataclass, field, replace, asdict, astuple
from std_msgs.msg import Float64, String


def singleton(cls):
    instances = {}

    @functools.wraps(cls)
    def get(*args, **kwargs):
        if cls not in instances:
            instances[cls] = cls(*args, **kwargs)
        return instances[cls]
    return get


def traced(cls):
    cls.trace = True
    return cls


@singleton
class Store:
    def __init__(self):
        self.data = {}

    def put(self, key, value):
        self.data[key] = value


class Registry:
    _instance = None

    def __new__(cls, *args, **kwargs):
        if cls._instance is None:
            cls._instance = super().__new__(cls)
            cls._instance.values = [0.0, 1.0]
        return cls._instance


@attr.s
class Limits(object):
    low = attr.ib(default=-1.0)
    high = attr.ib(default=1.0)
    last = attr.ib(default=0.0)


@attr.define
class Pose:
    x: float = 0.0
    y: float = 0.0


@traced
@dataclass(frozen=True)
class Snap:
    x: float = 0.0
    tag: str = "none"
    hist: list = field(default_factory=list)


def with_pub(topic):
    def wrap(fn):
        pub = rospy.Publisher(topic, Float64, queue_size=1)

        @functools.wraps(fn)
        def inner(*a, **k):
            result = fn(*a, **k)
            pub.publish(result)  # sink a b
            return result
        return inner
    return wrap


@with_pub("doubled")
def doubled(msg):
    Store().put("x", msg.data)
    Registry().values[0] = msg.data
    return 2 * msg.data


snap = Snap()
limits = Limits()
pose = Pose(1.0, 2.0)


@with_pub("second")
def second(msg):
    global snap
    out.publish(Store().data["x"])  # sink a
    out.publish(Registry().values[0])  # sink a
    out.publish(Registry().values[1])  # clean
    snap = replace(snap, x=msg.data)
    out.publish(snap.x)  # sink b
    txt.publish(snap.tag)  # clean
    limits.last = msg.data
    out.publish(limits.high)  # clean
    out.publish(limits.last)  # sink b
    moved = attr.evolve(pose, x=msg.data)
    out.publish(moved.y)  # clean
    out.publish(moved.x)  # sink b
    out.publish(asdict(snap)["x"])  # sink b
    out.publish(astuple(snap)[0])  # sink b
    return 0.5 * msg.data


rospy.init_node("cd")
out = rospy.Publisher("out", Float64, queue_size=1)
txt = rospy.Publisher("txt", String, queue_size=1)
rospy.Subscriber("a", Float64, doubled)  # source a
rospy.Subscriber("b", Float64, second)  # source b
rospy.spin()
