"""Loops that register something over a list that is unknown or empty, as in `names or []`."""

from __future__ import annotations

from textwrap import indent

import pytest

from tests.lint.models.marked import flows

NODE = """\
import os
import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        given = self.declare_parameter("topics", rclpy.Parameter.Type.STRING_ARRAY).value
{names}
        self.sent = []
{wiring}

    def forward(self, msg):
        for pub in self.sent:
            pub.publish(msg)  # there


rclpy.init()
rclpy.spin(Relay())
"""
WIRINGS = [
    """\
for name in names:
    pub = self.create_publisher(String, name + "/out", 1)
    self.create_subscription(String, name, lambda msg, pub=pub: pub.publish(msg), 1)  # there
""",
    """\
for name in names:
    self.sent.append(self.create_publisher(String, name, 1))
self.create_subscription(String, "in", self.forward, 1)
""",
    """\
for name in names:
    self.create_subscription(String, name, self.forward, 1)
self.sent.append(self.create_publisher(String, "out", 1))
""",
]
UNKNOWN_OR_EMPTY = [
    "names = given or []",
    "names = given or ()",
    "names = given or set()",
    "names = given or list()",
    "names = list(given or [])",
    "names = tuple(given or ())",
    "names = given if given else []",
    "names = [] if given is None else given",
    "names = given\nif not names:\n    names = []",
    "names = []\nif given:\n    names = given",
    "names = sys.argv[1:] or []",
    'names = os.environ["T"].split(",") if "T" in os.environ else []',
    "try:\n    names = given.split()\nexcept AttributeError:\n    names = []",
]
EMPTY = ["names = []", "names = ()"]


@pytest.mark.parametrize("wiring", WIRINGS)
@pytest.mark.parametrize("names", UNKNOWN_OR_EMPTY)
def test_possibly_empty_list_may_have_elements(names, wiring):
    text = NODE.format(names=indent(names, " " * 8), wiring=indent(wiring, " " * 8))
    lines = text.splitlines()
    assert [lines[flow.sink.span.line - 1].endswith("there") for flow in flows(text)] == [True]


@pytest.mark.parametrize("wiring", WIRINGS)
@pytest.mark.parametrize("names", EMPTY)
def test_a_loop_over_an_empty_list_registers_nothing(names, wiring):
    text = NODE.format(names=indent(names, " " * 8), wiring=indent(wiring, " " * 8))
    assert not flows(text)
