"""Topics, services and actions of a launch file that are used, but have no publisher or server."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.lint.test_system import MANIFEST, RELAY, relay, run, write

CLIENT = """\
#!/usr/bin/env python3
import actionlib
import rospy
from control_msgs.msg import GripperCommandAction
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
rospy.init_node("client")
out = rospy.Publisher("done", Float64, queue_size=1)
rospy.Subscriber("/clock", Clock, lambda msg: out.publish(1.0))
rospy.ServiceProxy("reset", Trigger)()
actionlib.SimpleActionClient("grip", GripperCommandAction).wait_for_server()
rospy.spin()
"""
CLIENT_NODE = '<node pkg="arm" type="client.py" name="client"/>'


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return write(
        tmp_path,
        {
            "arm/package.xml": MANIFEST.format("arm", "catkin"),
            "arm/scripts/relay.py": RELAY,
            "arm/scripts/client.py": CLIENT,
        },
    )


def listed(capsys: pytest.CaptureFixture[str], arm: Path, body: str) -> list[tuple[str, str, bool]]:
    write(arm, {"arm/launch/a.launch": f"<launch>{body}</launch>"})
    code, out, _ = run(capsys, "--launch", "a.launch", "--format", "json")
    assert code == 0
    (system,) = json.loads(out)["systems"]
    return [(one["missing"], one["name"], one["certain"]) for one in system.get("one_sided", ())]


def test_endpoints_without_the_other_side_are_listed(arm, capsys):
    assert listed(capsys, arm, relay("one", "scan", "out") + CLIENT_NODE) == [
        ("publishes", "/scan", True),
        ("serves", "/reset", True),
        ("performs", "/grip", True),
    ]
    out = run(capsys, "--launch", "a.launch")[1]
    assert "\nNo publisher here:\n  /scan (Float64): heard by /one\n" in out
    assert "\nNo server here:\n  /reset (Trigger): called by /client\n" in out
    assert "\nNo action server here:\n  /grip (GripperCommandAction): used by /client\n" in out
    assert "No publisher here" not in run(capsys, "--launch", "a.launch", "--from", "scan")[1]


def test_a_topic_is_listed_once_with_all_its_subscribers(arm, capsys):
    listed(capsys, arm, relay("one", "scan", "a") + relay("two", "/scan", "b"))
    assert "  /scan (Float64): heard by /one, /two\n" in run(capsys, "--launch", "a.launch")[1]


def test_published_topics_are_not_listed(arm, capsys):
    assert listed(capsys, arm, relay("one", "a", "b") + relay("two", "b", "a")) == []


def test_remapping_of_an_unread_node_may_be_the_publisher(arm, capsys):
    driver = '<node pkg="base" type="laser" name="laser"><remap from="out" to="/scan"/></node>'
    assert listed(capsys, arm, relay("one", "scan", "out") + driver) == []


def test_unread_parts_make_a_missing_endpoint_uncertain(arm, capsys):
    driver = '<node pkg="base" type="laser" name="laser"/>'
    assert listed(capsys, arm, relay("one", "scan", "out") + driver) == [("publishes", "/scan", False)]
    missing = '<include file="$(find base)/launch/base.launch"/>'
    assert listed(capsys, arm, relay("one", "scan", "out") + missing) == [("publishes", "/scan", False)]
    assert "heard by /one; a part that was not read may publish it" in run(capsys, "--launch", "a.launch")[1]


def test_names_that_only_the_robot_knows_are_not_listed(arm, capsys):
    assert (
        listed(
            capsys, arm, f'<arg name="robot"/><group ns="$(arg robot)">{relay("one", "scan", "out")}</group>'
        )
        == []
    )


def test_without_a_launch_file_no_missing_endpoints_are_listed(arm, capsys):
    document = json.loads(run(capsys, "--from", "in", "--format", "json")[1])
    assert all("one_sided" not in system for system in document["systems"])
