"""Names of topics, services and nodes: one set of rules for nodes, tests, sensors, faults and remappings."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl import faults, ros_names
from pytest_tarl.errors import RecordingError, SettingsError
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.ros import Ros, message_type
from pytest_tarl.ros.names import parse_ros2
from pytest_tarl.ros_names import Problem
from pytest_tarl.sensors import Sensor
from tests.plugin.ros.conftest import Start, heard

STRING, TRIGGER = message_type("std_msgs/String"), message_type("std_srvs/Trigger")
UNUSABLE = {
    "/my topic": "without ' '",
    "odom\n": r"without '\\n'",
    "/odom ": "without ' '",
    "a\u202eb": r"without '\\u202e'",
    "http://host": "without ':'",
    "/{ns}/odom": "without '{'",
    "a~b": "without '~'",
    "~odom": "must not be private.*'/node/odom'",
    "": "must not be empty",
    "/": "must not be empty",
}
USES: dict[str, Callable[[str], Any]] = {
    "publish": lambda name: Ros().bus.publish(name, STRING("x")),
    "subscribe": lambda name: Ros().bus.subscribe(name, print),
    "latest": lambda name: Ros().bus.latest(name),
    "serve": lambda name: Ros().bus.serve(name, TRIGGER, print),
    "call": lambda name: Ros().bus.call(name, TRIGGER._request_class()),
    "sensor": lambda name: Sensor("x", topic=name, field="data"),
    "signal": lambda name: Signal("x", topic=name, field="data"),
    "fault": lambda name: faults.dropout(name, 0.5),
}

# Name → problem in a topic, an absolute topic, a namespace and a node, as rclpy 9.1.2 reports them
CHARACTERS = "must not contain characters other than alphanumerics"
RULES: dict[str, tuple[str, str, str, str]] = {
    "a": ("", "must be absolute", "must be absolute", ""),
    "/a": ("", "", "", CHARACTERS),
    "/": ("end with a forward slash", "end with a '/'", "", CHARACTERS),
    "": ("must not be empty", "must not be empty", "must not be empty", "must not be empty"),
    "/a/": ("end with a forward slash", "end with a '/'", "end with a '/'", CHARACTERS),
    "/a//b": ("", "repeated '/'", "repeated '/'", CHARACTERS),
    "/a__b": ("", "", "", CHARACTERS),
    "a b": (CHARACTERS, "must be absolute", "must be absolute", CHARACTERS),
    "/é": (CHARACTERS, CHARACTERS, CHARACTERS, CHARACTERS),
    "1a": ("start with a number", "must be absolute", "must be absolute", "start with a number"),
    "/a/1": ("start with a number", "starts with a number", "starts with a number", CHARACTERS),
    "~": ("", "must be absolute", "must be absolute", CHARACTERS),
    "~/a": ("", "must be absolute", "must be absolute", CHARACTERS),
    "~ab": ("not followed by", "must be absolute", "must be absolute", CHARACTERS),
    "/~": ("unless it is the first", CHARACTERS, CHARACTERS, CHARACTERS),
    "{ns}1": ("", "must be absolute", "must be absolute", CHARACTERS),
    "{1}": ("start with a number", "must be absolute", "must be absolute", CHARACTERS),
    "{a/b}": ("substitution name must not contain", "must be absolute", "must be absolute", CHARACTERS),
    "{a": ("unbalanced", "must be absolute", "must be absolute", CHARACTERS),
    "a}": ("unbalanced", "must be absolute", "must be absolute", CHARACTERS),
}
CHECKS: tuple[Callable[[str], Problem | None], ...] = (
    ros_names.topic_problem,
    ros_names.full_topic_problem,
    ros_names.namespace_problem,
    ros_names.node_problem,
)


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("name", UNUSABLE)
def test_a_name_that_no_node_can_use_is_refused(use: str, name: str) -> None:
    if use == "fault" and not name:
        pytest.skip("faults ask for a text")
    with pytest.raises((RecordingError, SettingsError), match=UNUSABLE[name] if name.strip("/") else "must"):
        USES[use](name)


@pytest.mark.parametrize("name", ["odom", "/odom", "/a/_b", "/1", "/cam-1/image", "/bé"])
def test_a_name_that_a_node_can_use_is_accepted(name: str) -> None:
    assert ros_names.objection(name) == ""


@pytest.mark.parametrize("name", RULES)
def test_in_ros_2_names_follow_the_rules_of_rcl(name: str) -> None:
    for check, expected in zip(CHECKS, RULES[name], strict=True):
        problem = check(name)
        assert (problem is None) == (not expected), (check, problem)
        assert expected in (problem or ("", 0))[0]


def test_problem_index_points_at_the_wrong_character() -> None:
    found = [ros_names.topic_problem(name) for name in ("a b", "a/1", "ab{c", "ab/", "a/~b", "{a-}")]
    assert [problem[1] for problem in found if problem] == [1, 2, 2, 2, 2, 2]
    found = [ros_names.full_topic_problem(name) for name in ("/a//b", "/a/1", "/a b", "/ab/")]
    assert [problem[1] for problem in found if problem] == [3, 3, 2, 3]


@pytest.mark.parametrize(
    ("check", "longest"),
    [(ros_names.full_topic_problem, 247), (ros_names.namespace_problem, 245), (ros_names.node_problem, 255)],
)
def test_maximum_name_length_is_as_in_ros2(check: Callable[[str], Problem | None], longest: int) -> None:
    name = "/" + "a" * (longest - 1) if check is not ros_names.node_problem else "a" * longest
    assert check(name) is None
    assert "should not exceed" in (check(name + "a") or ("", 0))[0]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('node.create_publisher(String, "a b", 1)', "InvalidTopicNameException: Invalid topic name"),
        ('node.create_subscription(String, "é", print, 1)', "InvalidTopicNameException"),
        ('node.create_publisher(String, "a//b", 1)', "InvalidTopicNameException.*repeated"),
        ('node.create_publisher(String, "a" * 300, 1)', "InvalidTopicNameException.*should not exceed"),
        ('node.create_service(Trigger, "a b", print)', "InvalidServiceNameException: Invalid service name"),
        ('node.create_client(Trigger, "1")', "InvalidServiceNameException"),
        ('rclpy.create_node("1a")', "InvalidNodeNameException"),
        ('rclpy.create_node("b", namespace="/a b")', "InvalidNamespaceException"),
        ("node.create_publisher(String, 7, 1)", "TypeError.*must be a str, not int"),
    ],
)
def test_rclpy_refuses_invalid_names(start: Start, line: str, said: str) -> None:
    from pytest_tarl.errors import NodeError

    with pytest.raises(NodeError, match=rf"(?s){said}"):
        start(f"""
            import rclpy
            from std_msgs.msg import String
            from std_srvs.srv import Trigger
            rclpy.init()
            node = rclpy.create_node("n")
            {line}
        """)


@pytest.mark.parametrize(
    "line",
    [
        "rospy.Publisher({!r}, String)",
        "rospy.Subscriber({!r}, String)",
        "rospy.Service({!r}, Trigger, print)",
    ],
)
def test_rospy_warns_about_names_and_its_master_refuses_some(start: Start, line: str) -> None:
    node = "import rospy\nfrom std_msgs.msg import String\nfrom std_srvs.srv import Trigger\nrospy.init_node('n')\n"
    with pytest.warns(UserWarning, match="'cam-1' is not a legal ROS graph resource name") as warned:
        start(node + line.format("cam-1"))
    assert Path(warned[0].filename).name == "node.py"
    for refused in ("a b", "/a:b"):
        with (
            pytest.warns(UserWarning, match="not a legal"),
            pytest.raises(
                RecordingError, match=rf"'/n' names a (topic|service) '/{refused.strip('/')}'.*refuses"
            ),
        ):
            start(node + line.format(refused))


def test_rospy_warns_about_names_of_nodes_and_parameters(start: Start) -> None:
    with pytest.warns(UserWarning, match="'1n' is not a legal ROS base name"):
        start("import rospy; rospy.init_node('1n')")
    with pytest.warns(UserWarning, match="'a b' is not a legal ROS graph resource name"):
        start("import rospy; rospy.init_node('n'); rospy.set_param('a b', 1)")


def test_topic_with_a_hyphen_is_reached(start: Start) -> None:
    ros = start("pass")
    messages = heard(ros, "/cam-1")
    with pytest.warns(UserWarning, match="not a legal"):
        start(
            """
            import rospy
            from std_msgs.msg import String
            rospy.init_node("n")
            rospy.Publisher("cam-1", String, queue_size=1).publish("x")
            """,
            ros=ros,
        )
    assert [message.data for message in messages] == ["x"]


@pytest.mark.parametrize(
    "rule",
    ["a:=b c", "a:=b/", "a:=1", "a:=", "=b", "a:=~x", "a:={ns}/b", "a:=b//c", "a:=b:=c", "a:b", "__node:=a b",
     "__node:=1", "__ns:=a", "__ns:=/a b"],
)  # fmt: skip
def test_remapping_to_an_invalid_name_is_refused(rule: str) -> None:
    with pytest.raises(RuntimeError, match="Couldn't parse remap rule: '-r "):
        parse_ros2(["--ros-args", "-r", rule])


@pytest.mark.parametrize(
    "rule", ["a:=~/x", "n:a:=b", "rostopic://a:=b", "/*/a:=/\\1/b", "__ns:=/a", "__node:=a"]
)
def test_a_valid_remapping_is_accepted(rule: str) -> None:
    parse_ros2(["--ros-args", "-r", rule])


def test_a_remapping_of_a_test_is_checked() -> None:
    Ros(remappings={"a": "~b", "~c": "/d"})
    with pytest.raises(RecordingError, match=r"remapping of 'a' to 'b c' is invalid.*without ' '"):
        Ros(remappings={"a": "b c"})


def test_name_is_legal_if_rosgraph_accepts_it(start: Start) -> None:
    """Compare with the module of an installed ROS 1, if there is one."""
    python = shutil.which("python3", path="/usr/bin")
    names = ["", "a", "/a", "~a", "~/a", "1a", "/1", "_a", "/_a", "a b", "a-b", "a//b", "a/", "a/~b", "a:b"]
    code = f"import rosgraph.names as n; print([n.is_legal_name(one) for one in {names!r}])"
    real = python and subprocess.run([python, "-c", code], capture_output=True, text=True, check=False).stdout
    if not real:
        pytest.skip(f"{python or sys.executable} has no rosgraph")
    ros = start(f"import rosgraph.names as n; found = [n.is_legal_name(one) for one in {names!r}]")
    assert str(ros.namespace["found"]) == real.strip()  # type: ignore[attr-defined]
