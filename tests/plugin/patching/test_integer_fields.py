"""Constants that flow into integer fields of messages."""

from __future__ import annotations

import ast

import pytest

from pytest_tarl.patching.document import document
from pytest_tarl.patching.integer_fields import in_integer_field

HEAD = (
    "import std_msgs.msg\nfrom std_msgs.msg import Float64, Int32\nfrom std_msgs.msg import UInt8 as Byte\n"
)
HEAD += "from sensor_msgs.msg import Joy\nfrom nav_msgs.msg import Odometry\n"


@pytest.mark.parametrize(
    "code",
    [
        "pub.publish(Int32(data=7))",
        "pub.publish(Int32(7))",
        "pub.publish(Byte(data=7 if far else 1))",
        "pub.publish(std_msgs.msg.Int32(data=-7 + x))",
        "msg = Int32()\nmsg.data = 7",
        "msg = Int32()\nmsg.data += 7 * x",
        "self.out = Int32()\nself.out.data = 7",
        "odom = Odometry()\nodom.header.stamp.sec = 7",
        "joy = Joy()\njoy.buttons = [7, 0]",
        "joy = Joy()\njoy.buttons[0] = 7",
        "msg = Int32()\nlast = msg.data = 7",
        "msg = Int32()\nmsg.data = last = 7",
        "msg = Int32()\nmsg.data: int = 7",
        "joy = Joy()\njoy.buttons = (1, 7)",
    ],
)
def test_a_constant_in_an_integer_field_stays_an_integer(code: str) -> None:
    assert seven(code)


@pytest.mark.parametrize(
    "code",
    [
        "pub.publish(Float64(data=7))",
        "pub.publish(Float64(7))",
        "print(7)",
        "msg = Float64()\nmsg.data = 7",
        "joy = Joy()\njoy.axes = [7, 0]",
        "msg = Int32()\nmsg.data = 1 if x > 7 else 0",
        "msg = Int32()\nmsg.data = int(7 * x)",
        "msg = Mine()\nmsg.data = 7",
        "speed = 7",
        "joy = Joy()\njoy.buttons[7] = 1",
        "msg = Int32()\nlast = first = 7",
        "msg = Int32()\nmsg.data = steps[7]",
    ],
)
def test_constant_outside_an_integer_field_may_be_a_fraction(code: str) -> None:
    assert not seven(code)


def seven(code: str) -> bool:
    source = document("node.py", HEAD + code + "\n")
    (node,) = [one for one in ast.walk(source.tree) if isinstance(one, ast.Constant) and one.value == 7]
    return in_integer_field(source, node)
