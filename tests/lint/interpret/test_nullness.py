"""A check for None depends on data if it shows what a message contains, not if it shows that a message has arrived."""

from __future__ import annotations

from textwrap import dedent, indent

import pytest

from tests.lint.models.marked import differing

NODE = """\
import rospy
from std_msgs.msg import Float64

out = rospy.Publisher("out", Float64, queue_size=1)
{head}

last, found, table, pair = None, None, {{"a": None, "b": None}}, [None, None]
level, high = None, None

def on(msg):
    global last, found, level, high
    last, level = msg, msg.data + 1.0
    if msg.data > 0.0:
        found, high = msg, msg.data + 1.0
    table["a"] = msg
    pair[0] = msg

def tick(event):
{body}

rospy.Subscriber("in", Float64, on)
rospy.Timer(rospy.Duration(1.0), tick)
rospy.spin()
"""
GATED = "if {value} is not None:\n    out.publish(1.0)  # {flows}"


def node(body: str, head: str = "") -> str:
    return NODE.format(head=dedent(head), body=indent(body, "    "))


@pytest.mark.parametrize(
    ("before", "value", "flows"),
    [
        ("", "last", "clean"),
        ("", "found", "control"),
        ("", "level", "clean"),
        ("", "high", "control"),
        ("value = level", "value", "clean"),
        ("value = high", "value", "control"),
        ("value = last", "value", "clean"),
        ("value = found", "value", "control"),
        ("", "table['a']", "clean"),
        ("", "pair[0]", "clean"),
        ("value, _ = pair", "value", "clean"),
        ("value = last.data if last.data > 0.0 else None", "value", "control"),
        ("value = table.get(last.name)", "value", "control"),
    ],
)
def test_comparison_with_none_depends_on_data_that_decides_nullness(before, value, flows):
    assert differing(node(f"{before}\n{GATED.format(value=value, flows=flows)}".strip())) == {}


@pytest.mark.parametrize(
    ("given", "flows"),
    [
        ("last", "clean"),
        ("found", "control"),
        ("table['a']", "clean"),
        ("last.data > 0.0 or None", "control"),
    ],
)
def test_a_parameter_may_be_none_if_the_argument_may_be(given, flows):
    head = "def send(value):\n" + indent(GATED.format(value="value", flows=flows), "    ")
    assert differing(node(f"send({given})", head)) == {}


@pytest.mark.parametrize(
    ("result", "flows"),
    [("last", "clean"), ("found", "control"), ("level", "clean"), ("high", "control"), ("None", "clean")],
)
def test_call_may_return_none_if_its_value_may_be_none(result, flows):
    head = f"def asked():\n    return {result}"
    assert differing(node(GATED.format(value="asked()", flows=flows), head)) == {}


POSE = """\
import rospy
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64
from unknown.msg import Track

out = rospy.Publisher("out", Float64, queue_size=1)
kept = None

def on(msg):
    global kept
    kept = {field}

def tick(event):
    if {test}:
        out.publish(1.0)  # {flows}

rospy.Subscriber("in", {kind}, on)
rospy.Timer(rospy.Duration(1.0), tick)
rospy.spin()
"""


@pytest.mark.parametrize("test", ["kept", "not kept", "kept and True", "bool(kept)"])
@pytest.mark.parametrize(
    ("kind", "field", "flows"),
    [
        ("PoseStamped", "msg", "clean"),
        ("PoseStamped", "msg.pose", "clean"),
        ("PoseStamped", "msg.pose.position", "clean"),
        ("PoseStamped", "msg.pose.position.x", "control"),
        ("PoseStamped", "msg.header.stamp", "control"),
        ("Track", "msg.pose", "control"),
    ],
)
def test_truth_of_a_field_depends_on_data(kind, field, flows, test):
    assert differing(POSE.format(kind=kind, field=field, flows=flows, test=test)) == {}
