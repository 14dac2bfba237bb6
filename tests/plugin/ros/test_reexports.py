"""Names that modules of ROS re-export."""

from __future__ import annotations

import sys
from importlib import import_module

import pytest

from pytest_tarl.ros.reexports import REEXPORTED
from pytest_tarl.ros.standins import STANDINS
from tests.plugin.ros.conftest import Start

KINDS = {
    "rclpy": "import rclpy",
    "rospy": "import rospy",
    "actionlib": "import rospy",
    "tf2_ros": "import rospy",
}


@pytest.mark.parametrize("module", sorted(REEXPORTED))
def test_every_reexported_name_exists(module: str, start: Start) -> None:
    contents = vars(import_module("pytest_tarl.ros." + STANDINS[module]))
    names = [one for names in REEXPORTED[module].values() for one in names.split()]
    plain = [one.partition("=")[0] for one in names]
    assert len(set(plain)) == len(plain)
    assert not set(plain) & set(contents)
    start(f"{KINDS[module.partition('.')[0]]}\nfrom {module} import {', '.join(plain)}\n")
    for home, listed in REEXPORTED[module].items():
        for name in listed.split():
            own, _, original = name.partition("=")
            assert getattr(sys.modules[module], own) is getattr(sys.modules[home], original or own)


def test_suggested_modules_can_be_imported(start: Start) -> None:
    ros = start("""
        import rclpy
        from rclpy.node import Node, ParameterDescriptor, QoSProfile, ReentrantCallbackGroup
        from rclpy.parameter import ParameterMsg
        from std_msgs.msg import String
        rclpy.init()
        node = Node("n")
        node.declare_parameter("gain", 1.5, ParameterDescriptor(description="of the loop"))
        heard = []
        group = ReentrantCallbackGroup()
        node.create_subscription(String, "a", heard.append, QoSProfile(depth=1), callback_group=group)
        rclpy.spin_once(node, timeout_sec=0.5)
        found = (node.get_parameter("gain").value, ParameterMsg(name="x").name)
    """)
    ros.step(1.0)
    assert ros.namespace["found"] == (1.5, "x")  # type: ignore[attr-defined]
