"""Members of enumerations: looked up by data, and with values that are tuples, properties and `__init__`."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, differing_topics, flows, sections

HEAD = """\
import enum, rospy
from std_msgs.msg import Float64, UInt8
class Phase(enum.Enum):
    STANCE = 0
    SWING = 1
    def speed(self):
        return 0.5 * self.value
class Plain:
    def __init__(self, number):
        self.number = number
out = rospy.Publisher("out", Float64, queue_size=1)
"""
BODIES = {
    "identity": """
    if Phase(msg.data) is Phase.STANCE:
        out.publish(1.0)  # control
    out.publish(2.0)  # clean
""",
    "equality": """
    if Phase(msg.data) != Phase.STANCE:
        out.publish(1.0)  # control
""",
    "the value": """
    out.publish(Phase(msg.data).value)  # data
""",
    "a method": """
    out.publish(Phase(msg.data).speed())  # data
""",
    "a value that is no member": """
    try:
        Phase(msg.data)
    except ValueError:
        return
    out.publish(1.0)  # control
""",
    "a known value": """
    if Phase(1) is Phase.STANCE:
        out.publish(1.0)  # clean
    out.publish(Phase(1).speed())  # clean
""",
    "the identity of another object": """
    if Plain(msg.data) is not None:
        out.publish(1.0)  # clean
""",
}
TAIL = """
rospy.Subscriber("in", UInt8, on)
rospy.spin()
"""


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_member_follows_the_data_of_its_value(body: str) -> None:
    assert differing(HEAD + "def on(msg):" + body + TAIL) == {}


FLEET = """\
import enum, functools, rospy
from std_msgs.msg import Float64, UInt8
class Channel(enum.Enum):
    HIP = ("hip", Float64)
    KNEE = ("knee", Float64)
    HEEL = ("heel", UInt8)
    {body}
class Leg:
    def __init__(self):
        self.samples = {{channel: 0.0 for channel in Channel}}
        self.outs = {{}}
        for channel in Channel:
            rospy.Subscriber(channel.topic, channel.kind, {callback})
            self.outs[channel] = rospy.Publisher(channel.name + "/out", Float64, queue_size=1)
        rospy.Timer(1.0, self.step)
    def on(self, channel, msg):
        self.samples[channel] = msg.data
    def step(self, event):
        self.outs[Channel.HIP].publish(self.samples[Channel.HEEL])
        self.outs[Channel.KNEE].publish(self.samples[Channel["KNEE"]])
Leg()
rospy.spin()
"""
STYLES = {
    "properties": """
    @property
    def topic(self):
        return self.value[0]
    @property
    def kind(self):
        return self.value[1]
""",
    "attributes set by __init__": """
    def __init__(self, topic, kind):
        self.topic = topic
        self.kind = kind
""",
    "a property of a base class": "",
}
BASE = """
class Described(enum.Enum):
    @property
    def topic(self):
        return self.value[0]
    @property
    def kind(self):
        return self.value[1]
class Channel(Described):"""
CALLBACKS = ("functools.partial(self.on, channel)", "lambda msg, channel=channel: self.on(channel, msg)")


@pytest.mark.parametrize("callback", CALLBACKS)
@pytest.mark.parametrize("style", STYLES)
def test_enum_members_with_tuples_name_topics(style: str, callback: str) -> None:
    text = FLEET.format(body=STYLES[style].strip() or "pass", callback=callback)
    if style == "a property of a base class":
        text = text.replace("\nclass Channel(enum.Enum):", BASE)
    found = sorted((flow.source.topics, flow.sink.topics, flow.kind) for flow in flows(text))
    assert found == [(("heel",), ("HIP/out",), "explicit"), (("knee",), ("KNEE/out",), "explicit")]


def test_member_chosen_by_data_may_be_any_member() -> None:
    text = FLEET.format(body=STYLES["properties"].strip(), callback=CALLBACKS[0])
    text = text.replace(
        'self.samples[Channel["KNEE"]]', "self.samples[list(Channel)[int(event.last_duration)]]"
    )
    knee = {flow.source.topics for flow in flows(text) if flow.sink.topics == ("KNEE/out",)}
    assert knee == {("heel",), ("hip",), ("knee",)}


CONSTANT = """\
import enum, functools, rospy
from enum import Enum, auto
from std_msgs.msg import Float64
out = rospy.Publisher("out", Float64, queue_size=1)
"""
# Programs with members that have constant values, each below its title.
CONSTANTS = """\
### properties of members with texts
class Channel(Enum):
    FRONT = "front"
    REAR = "rear"
    @property
    def topic(self):
        return f"range/{self.value}"
kept = {channel: 0.0 for channel in Channel}
def on(channel, msg):
    kept[channel] = msg.data
    out.publish(kept[Channel.REAR])  # range/rear:data
for one in Channel:
    rospy.Subscriber(one.topic, Float64, functools.partial(on, one))
### automatic numbers are keys of their own
class Channel(enum.Enum):
    FRONT = enum.auto()
    REAR = enum.auto()
kept = {}
def on(channel, msg):
    kept[channel] = msg.data
    out.publish(kept[Channel.REAR])  # b:data
rospy.Subscriber("a", Float64, functools.partial(on, Channel.FRONT))
rospy.Subscriber("b", Float64, functools.partial(on, Channel.REAR))
### automatic numbers are told apart
class Side(Enum):
    LEFT = auto()
    RIGHT = auto()
def on(side, msg):
    if side is Side.LEFT:
        out.publish(msg.data)  # a:data
    match side:
        case Side.RIGHT:
            out.publish(msg.data)  # b:data
rospy.Subscriber("a", Float64, functools.partial(on, Side.LEFT))
rospy.Subscriber("b", Float64, functools.partial(on, Side.RIGHT))
### an automatic number after a known one
class Side(enum.IntEnum):
    LEFT = 4
    RIGHT = auto()
def on(msg):
    if Side.RIGHT == 5:
        out.publish(1.0)  # clean
    else:
        out.publish(msg.data)  # clean
rospy.Subscriber("a", Float64, on)
### automatic texts
class Topic(enum.StrEnum):
    SCAN = auto()
    ODOM = auto()
def on(msg):
    out.publish(msg.data)  # odom:data scan:data
for topic in Topic:
    rospy.Subscriber(topic, Float64, on)
### members of an enumeration with methods are told apart
class Side(Enum):
    LEFT = 1
    RIGHT = 2
    def other(self):
        return Side.RIGHT if self is Side.LEFT else Side.LEFT
def on(side, msg):
    if side.other() is Side.LEFT:
        out.publish(msg.data)  # b:data
rospy.Subscriber("a", Float64, functools.partial(on, Side.LEFT))
rospy.Subscriber("b", Float64, functools.partial(on, Side.RIGHT))
### a method with the data of a message
class Unit(Enum):
    METRE = 1.0
    FOOT = 0.3
    def convert(self, number):
        return number * self.value
rospy.Subscriber("a", Float64, lambda msg: out.publish(Unit.FOOT.convert(msg.data)))  # a:data
### a constant value of a member
class Unit(Enum):
    METRE = 1.0
    FOOT = 0.3
    def double(self):
        return 2 * self.value
rospy.Subscriber("a", Float64, lambda msg: out.publish(Unit.FOOT.double()))  # clean
### a state that data decides
class State(Enum):
    IDLE = 0
    BUSY = 1
    def speed(self):
        return {State.IDLE: 0.0, State.BUSY: 1.0}[self]
state = State.IDLE
def on(msg):
    global state
    if msg.data > 1.0:
        state = State.BUSY
    out.publish(state.speed())  # a:control
rospy.Subscriber("a", Float64, on)
### a state that never changes
class State(Enum):
    IDLE = 0
    BUSY = 1
    def busy(self):
        return self is State.BUSY
state = State.IDLE
def on(msg):
    if state.busy():
        out.publish(msg.data)  # clean
rospy.Subscriber("a", Float64, on)
### __init__ of a base class, with a tuple and with a single value
class Named(Enum):
    def __init__(self, topic, scale=1.0):
        self.topic = topic
        self.scale = scale
class Level(Named):
    LOW = ("low", 0.5)
    HIGH = "high"
kept = {}
def on(level, msg):
    kept[level] = msg.data * level.scale
    out.publish(kept[Level.HIGH])  # high:data
for level in Level:
    rospy.Subscriber(level.topic, Float64, functools.partial(on, level))
### a member looked up by its constant value
class Channel(Enum):
    FRONT = "front"
    REAR = "rear"
    @property
    def topic(self):
        return f"range/{self.value}"
rospy.Subscriber(Channel("rear").topic, Float64, lambda msg: out.publish(msg.data))  # range/rear:data
### names of members
class Channel(Enum):
    FRONT = 1
    REAR = 2
    @classmethod
    def all(cls):
        return list(cls)
def on(msg):
    out.publish(msg.data)  # FRONT:data REAR:data
for channel in Channel.all():
    rospy.Subscriber(channel.name, Float64, on)
### members of a copied list, by __members__, and with computed values
class Kind(Enum):
    SCAN = 1 << 3
    IMU = 1 << 4
kept, named = {}, {}
def on(kind, msg):
    kept[kind] = msg.data
    out.publish(kept[Kind.IMU])  # a/IMU:data
def on_named(msg, kind):
    named[kind.name] = msg.data
    out.publish(named["SCAN"])  # b/scan:data
for kind in list(Kind):
    rospy.Subscriber("a/" + kind.name, Float64, functools.partial(on, kind))
for name, kind in Kind.__members__.items():
    rospy.Subscriber("b/" + name.lower(), Float64, lambda msg, kind=kind: on_named(msg, kind))
### a member chosen by a condition
class Mode(Enum):
    SLOW = 1.0
    FAST = (2.0, "fast")
def on(msg):
    mode = Mode.SLOW
    out.publish(mode.value)  # clean
    if msg.data > 0.0:
        mode = Mode.FAST
    out.publish(mode.value)  # a:control
    out.publish(mode.name)  # a:control
    out.publish(mode is Mode.FAST)  # a:control
rospy.Subscriber("a", Float64, on)
### __str__ of members
class Topic(Enum):
    SCAN = "scan"
    ODOM = "odom"
    def __str__(self):
        return self.value
rospy.Subscriber(str(Topic.SCAN), Float64, lambda msg: out.publish(msg.data))  # scan:data
rospy.Subscriber(f"{Topic.ODOM}", Float64, lambda msg: out.publish(msg.data))  # odom:data
"""


@pytest.mark.parametrize("program", sections(CONSTANTS).values(), ids=sections(CONSTANTS))
def test_enumeration_members_have_their_constant_values(program: str) -> None:
    assert differing_topics(CONSTANT + program) == {}
