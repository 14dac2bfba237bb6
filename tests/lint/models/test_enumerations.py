"""Members of enumerations: looked up by data, and with values that are tuples, properties and `__init__`."""

from __future__ import annotations

import pytest

from tests.lint.models.marked import differing, flows

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
def test_members_with_tuples_name_topics_and_are_keys_of_their_own(style: str, callback: str) -> None:
    text = FLEET.format(body=STYLES[style].strip() or "pass", callback=callback)
    if style == "a property of a base class":
        text = text.replace("\nclass Channel(enum.Enum):", BASE)
    found = sorted((flow.source.topics, flow.sink.topics, flow.kind) for flow in flows(text))
    assert found == [(("heel",), ("HIP/out",), "explicit"), (("knee",), ("KNEE/out",), "explicit")]


def test_the_data_of_a_member_that_is_chosen_by_data_may_be_that_of_any_member() -> None:
    text = FLEET.format(body=STYLES["properties"].strip(), callback=CALLBACKS[0])
    text = text.replace(
        'self.samples[Channel["KNEE"]]', "self.samples[list(Channel)[int(event.last_duration)]]"
    )
    knee = {flow.source.topics for flow in flows(text) if flow.sink.topics == ("KNEE/out",)}
    assert knee == {("heel",), ("hip",), ("knee",)}
