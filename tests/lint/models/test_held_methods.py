"""A method that makes a subscription, a publisher or a service may be held in a variable before it is called."""

from __future__ import annotations

import pytest

from tarl_lint.interpret.node_starts import STARTING
from tests.lint.models.marked import flows

BRIDGE = """\
import rclpy
from std_msgs.msg import Float64

class Bridge:
    def __init__(self, node):
        self.node = node
        {make}

    def receive(self, msg):
        self.pub.publish(msg)

{main}
"""
PLAIN = 'self.pub = node.create_publisher(Float64, "out", 10)\n        {subscribe}'
DIRECT = 'node.create_subscription(Float64, "in", self.receive, 10)'
HELD = {
    "a variable": 'make = node.create_subscription; make(Float64, "in", self.receive, 10)',
    "getattr": 'make = getattr(node, "create_subscription"); make(Float64, "in", self.receive, 10)',
    "getattr with a default": """make = getattr(node, "create_subscription", None)
        if callable(make):
            make(Float64, "in", self.receive, 10)""",
    "getattr, called at once": 'getattr(node, "create_subscription")(Float64, "in", self.receive, 10)',
    "an attribute": 'self.make = node.create_subscription; self.make(Float64, "in", self.receive, 10)',
}
MAINS = {
    "a node of a library": 'Bridge(rclpy.create_node("bridge"))',
    "an unknown node": "",
    "an unknown node, passed by a program": "def main(node):\n    Bridge(node)",
}


def ends(make: str, main: str) -> list[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    found = flows(BRIDGE.format(make=make, main=main))
    return [(flow.kind, flow.source.topics, flow.sink.topics) for flow in found]


@pytest.mark.parametrize("main", MAINS.values(), ids=MAINS)
@pytest.mark.parametrize("subscribe", [DIRECT, *HELD.values()], ids=["called directly", *HELD])
def test_stored_subscribe_method_makes_a_subscription(subscribe, main):
    assert ends(PLAIN.format(subscribe=subscribe), main) == [("explicit", ("in",), ("out",))]


@pytest.mark.parametrize("main", MAINS.values(), ids=MAINS)
def test_stored_publisher_method_makes_a_publisher(main):
    make = 'make = node.create_publisher; self.pub = make(Float64, "out", 10)'
    assert ends(f"{make}\n        {DIRECT}", main) == [("explicit", ("in",), ("out",))]


def test_stored_reference_to_an_unknown_method_creates_no_endpoint():
    subscribe = 'make = node.create_something; make(Float64, "in", self.receive, 10)'
    assert ends(PLAIN.format(subscribe=subscribe), MAINS["a node of a library"]) == []


@pytest.mark.parametrize(
    ("text", "starts"),
    [
        ("node.create_subscription(", True),
        ("make = node.create_service\n", True),
        ('getattr(node, "create_subscription")', True),
        ("node.create_publisher(", False),
        ("recreate_subscription", False),
        ("create_subscriptions", False),
    ],
)
def test_file_that_stores_a_publisher_method_may_start_a_node(text, starts):
    assert (STARTING.search(text) is not None) is starts
