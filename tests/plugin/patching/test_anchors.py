"""Where another subscription can be made in nodes that have none which can be used."""

from __future__ import annotations

import ast
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.anchors import anchors

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
def test_the_first_place_is_the_call_that_starts_the_node(text: str, beside: str, node: str) -> None:
    analysis: Any = SimpleNamespace(flows=[], sources={"pilot.py": text})
    site: Any = None
    first, *_ = anchors(analysis, site, "pilot.py")
    assert (ast.unparse(first.statement), first.node, first.after) == (beside, node, True)
