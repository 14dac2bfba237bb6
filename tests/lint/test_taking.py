"""Unpacking: only the part with the message is tainted."""

import pytest

from tests.lint.analysing import analysed

NODE = """
import rospy
from std_msgs.msg import Float64

pub = rospy.Publisher("out", Float64, queue_size=1)

class Pairs:
    def __init__(self, value):
        self.value = value
    def __iter__(self):
        self.turn = 0
        return self
    def __next__(self):
        self.turn += 1
        return self.turn, self.value

def on_value(msg):
    pair = ("left", msg.data)
    table = {{"a": 0.0, "b": msg.data}}
{body}
    pub.publish(value)

rospy.Subscriber("in", Float64, on_value)
"""


@pytest.mark.parametrize(
    ("body", "flows"),
    [
        ("_, *rest, value = (0.0, 0.0, 0.0, msg.data)", 1),
        ("_, *rest, value = (0.0, msg.data, msg.data, 0.0)", 0),
        ("*rest, _ = (0.0, msg.data, 0.0)\nvalue = rest[1]", 1),
        ("*rest, _ = (0.0, 0.0, msg.data)\nvalue = rest[1]", 0),
        ("match pair:\n    case (_, value): pass", 1),
        ("match pair:\n    case (value, _): pass", 0),
        ("match table:\n    case {'b': value}: pass", 1),
        ("match table:\n    case {'a': value}: pass", 0),
        ("match msg:\n    case Float64(data=value): pass", 1),
        ("value = 0.0\nmatch msg.data:\n    case found if found > 0.0:\n        value = found", 1),
        ("for _, value in Pairs(msg.data): pass", 1),
        ("for value, _ in Pairs(msg.data): pass", 0),
    ],
)
def test_only_the_unpacked_part_with_the_message_is_tainted(tmp_path, body, flows):
    text = NODE.format(body="\n".join(f"    {line}" for line in body.split("\n")))
    assert len([f for f in analysed(tmp_path, node=text).flows if f.kind == "explicit"]) == flows
