import abc
from typing import Protocol, TypedDict, NamedTuple, Generic, TypeVar, Optional
import rospy
from std_msgs.msg import Float64, Bool
from sensor_msgs.msg import Range

T = TypeVar("T")


class Reading(NamedTuple):
    value: float
    limit: float


class State(TypedDict, total=False):
    last: float
    limit: float


class Strategy(Protocol):
    def decide(self, reading: Reading) -> float: ...


class NodeBase(abc.ABC):
    topic = "base"
    msg_type = Float64
    registry = []

    def __init_subclass__(cls, **kw):
        super().__init_subclass__(**kw)
        NodeBase.registry.append(cls)

    def __init__(self, name):
        self.name = name
        self.setup()
        self.sub = rospy.Subscriber(self.topic, self.msg_type, self.handle)  # source base

    def setup(self):
        pass

    @abc.abstractmethod
    def handle(self, msg):
        raise NotImplementedError


class Latch(Generic[T]):
    def __init__(self, value: Optional[T] = None):
        self._value = value

    def set(self, value: T):
        self._value = value

    def get(self) -> Optional[T]:
        return self._value


class Half:
    def decide(self, reading):
        return reading.value / 2


class Fixed:
    def decide(self, reading):
        return 1.0


class RangeNode(NodeBase):
    topic = "range"
    msg_type = Range

    def setup(self):
        self.pub = rospy.Publisher("half", Float64, queue_size=1)
        self.fix = rospy.Publisher("fixed", Float64, queue_size=1)
        self.lim = rospy.Publisher("limit", Float64, queue_size=1)
        self.latch = Latch(0.0)
        self.other = Latch(1.0)
        self.state: State = {"limit": 1.0}
        self.strategies = [Half(), Fixed()]

    def handle(self, msg):
        reading = Reading(msg.range, 2.0)
        self.latch.set(reading.value)
        self.state["last"] = reading.value
        self.pub.publish(self.strategies[0].decide(reading))  # sink base
        self.fix.publish(self.strategies[1].decide(reading))  # clean
        self.lim.publish(reading.limit)  # clean
        self.lim.publish(self.state["limit"])  # clean
        self.lim.publish(self.state["last"])  # sink base
        self.lim.publish(self.latch.get())  # sink base
        self.lim.publish(self.other.get())  # clean
        value, limit = reading
        self.lim.publish(limit)  # clean
        self.lim.publish(reading[0])  # sink base
        self.lim.publish(reading._replace(value=0.0).value)  # clean
        self.lim.publish(reading._asdict()["value"])  # sink base


def main():
    rospy.init_node("r")
    node = RangeNode("r")
    rospy.spin()


main()
