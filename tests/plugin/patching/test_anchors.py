"""Places for a new subscription in nodes without a subscription beside which it could be made."""

from __future__ import annotations

import ast
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.anchors import anchors, beside
from pytest_tarl.patching.document import document

CLASS = """\
import rclpy
from rclpy.node import Node


class Helper:
    def __init__(self):
        super().__init__()


class Pilot(Node):
    def __init__(self):
        self.gains = load()
        super().__init__("pilot")
        self.helper = Helper()


def main():
    rclpy.init()
    node = Pilot()
    node.get_logger().info("ready")
    rclpy.spin(node)
"""
FUNCTION = """\
import rclpy


def later(node):
    node.create_timer(1.0, print)


def main():
    rclpy.init()
    print("starting")
    node = rclpy.create_node("pilot")
    rclpy.spin(node)
"""
SCRIPT = """\
import rospy

print("starting")
rospy.init_node("pilot")
rospy.spin()
"""


@pytest.mark.parametrize(
    ("text", "beside", "node"),
    [
        (CLASS, "super().__init__('pilot')", "self"),
        (FUNCTION, "node = rclpy.create_node('pilot')", "node"),
        (SCRIPT, "rospy.init_node('pilot')", ""),
    ],
    ids=["class", "function", "script"],
)
def test_subscription_is_placed_at_the_call_that_starts_the_node(text: str, beside: str, node: str) -> None:
    analysis: Any = SimpleNamespace(flows=[], sources={"pilot.py": text})
    site: Any = None
    first, *_ = anchors(analysis, site, "pilot.py")
    assert (ast.unparse(first.statement), first.node, first.after) == (beside, node, True)


BESIDE = """\
import rospy

def main():
    rospy.init_node("pilot")
    {}
    rospy.spin()
"""


@pytest.mark.parametrize(
    ("code", "statement", "after"),
    [
        ("sub = subscribe('/a')", "sub = subscribe('/a')", True),
        ("if subscribe('/a'): pass", "if subscribe('/a'):\n    pass", False),
        ("with subscribe('/a'): pass", "with subscribe('/a'):\n    pass", False),
        ("return subscribe('/a')", "return subscribe('/a')", False),
        ("for _ in range(3): subscribe('/a')", "for _ in range(3):\n    subscribe('/a')", False),
        (
            "while True:\n        if True: subscribe('/a')",
            "while True:\n    if True:\n        subscribe('/a')",
            False,
        ),
        ("print(); subscribe('/a'); print()", "print()", False),
    ],
)
def test_subscription_is_added_beside_one_that_runs_once(code: str, statement: str, after: bool) -> None:
    source = document("pilot.py", BESIDE.format(code))
    (call,) = (
        node
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Call) and ast.unparse(node) == "subscribe('/a')"
    )
    found = beside(source, call, "node")
    assert found is not None
    assert (ast.unparse(found.statement), found.after, found.node) == (statement, after, "node")


@pytest.mark.parametrize(
    ("line", "nodes"),
    [
        ("rclpy.spin(rclpy.create_node('pilot'))", []),
        ("wrapped = Wrapper(rclpy.create_node('pilot'))", []),
        ("node = Wrapper(rclpy.create_node('pilot'))\n    node.create_timer(1.0, print)", ["node", "node"]),
        ("self.node = rclpy.create_node('pilot')", ["self.node"]),
    ],
)
def test_node_is_named_only_where_assigned_or_used(line: str, nodes: list[str]) -> None:
    text = f"import rclpy\n\n\ndef main():\n    {line}\n"
    analysis: Any = SimpleNamespace(flows=[], sources={"pilot.py": text})
    site: Any = None
    assert [found.node for found in anchors(analysis, site, "pilot.py")] == nodes


USED = """\
import rclpy


def later(node):
    node.create_timer(1.0, print)


class Holder:
    def __init__(self, node):
        node.create_publisher(Float64, "/a", 1)

    def on_start(self, node):
        node.create_service(Trigger, "/b", print)


def main():
    rclpy.init()
    node = made()
    node.declare_parameter("kp", 1.0)
    print(node)


node = made()
node.create_subscription(Float64, "/c", print, 1)
"""


def test_calls_in_main_and_init_are_the_first_places() -> None:
    analysis: Any = SimpleNamespace(flows=[], sources={"pilot.py": USED})
    site: Any = None
    found = [ast.unparse(one.statement).partition("(")[0] for one in anchors(analysis, site, "pilot.py")]
    assert set(found[:3]) == {"node.create_subscription", "node.create_publisher", "node.declare_parameter"}
    assert set(found[3:]) == {"node.create_timer", "node.create_service"}
    assert len(found) == 5


def test_a_file_that_cannot_be_parsed_starts_no_node() -> None:
    analysis: Any = SimpleNamespace(flows=[], sources={"a.py": "def (", "pilot.py": SCRIPT})
    site: Any = None
    assert [one.source.path for one in anchors(analysis, site, "a.py")] == ["pilot.py"]
