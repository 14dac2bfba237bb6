"""Launched nodes of well-known packages: the types that they may use, and what follows for topics with one end."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import ALL, Request, systems
from tarl_lint.system.hazards import hazards
from tarl_lint.system.known_packages import kinds, typed
from tarl_lint.system.model import Instance
from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.message_files import fields, parsed
from tarl_lint.workspace.read import read

PILOT = """
import rospy
from geometry_msgs.msg import {kind}
from sensor_msgs.msg import LaserScan
rospy.init_node("pilot")
pub = rospy.Publisher("/cmd_vel", {kind}, queue_size=1)
rospy.Subscriber("scan", LaserScan, lambda scan: pub.publish({kind}()))
rospy.spin()
"""
BASE = """
import rospy
from geometry_msgs.msg import {kind}
rospy.init_node("base")
rospy.Subscriber("cmd_vel", {kind}, print)
rospy.spin()
"""
NODE = '<node pkg="{}" type="{}" name="other"/>'
PAIR = """
<launch>
  <group ns="robot">
    <node pkg="robot" type="pilot.py" name="pilot"/>
    <node pkg="robot" type="base.py" name="base"/>
    {}
  </group>
</launch>
"""


def codes(root: Path, launch: str, pilot: str = "Twist", base: str = "Twist") -> list[str]:
    """Return the hazards of a workspace with a pilot and a base."""
    (root / "robot/launch").mkdir(parents=True, exist_ok=True)
    (root / "robot/package.xml").write_text("<package><name>robot</name></package>")
    (root / "robot/launch/r.launch").write_text(dedent(launch).strip())
    (root / "robot/pilot.py").write_text("#!/usr/bin/env python3" + PILOT.format(kind=pilot))
    (root / "robot/base.py").write_text("#!/usr/bin/env python3" + BASE.format(kind=base))
    config = resolve(Options((root,), select=("TARL3",)))
    return [one.code for each in systems(Request(ALL, (), (root,)), config) for one in hazards(each, config)]


@pytest.mark.parametrize(
    ("package", "program", "found"),
    [
        ("urg_node", "urg_node", ["TARL301"]),
        ("usb_cam", "usb_cam_node", ["TARL301"]),
        ("twist_mux", "twist_mux", []),
        ("move_base", "move_base", []),
        ("unknown_driver", "node", []),
        ("map_server", "map_saver", ["TARL301"]),
        ("rviz", "rviz", ["TARL301"]),
        ("openni2_camera", "openni2_camera_node", ["TARL301"]),
        ("robot_pose_ekf", "robot_pose_ekf", ["TARL301"]),
        ("radar_driver", "radar", ["TARL301"]),
        ("laser_scan_matcher", "laser_scan_matcher_node", []),
        ("tilting_laser", "tilt", []),
    ],
)
def test_unread_node_is_the_other_end_only_with_a_matching_type(tmp_path, package, program, found):
    assert codes(tmp_path, PAIR.format(NODE.format(package, program))) == found


def test_the_velocities_of_a_multiplexer_are_twists(tmp_path):
    mux = '<node pkg="twist_mux" type="twist_mux" name="m"><remap from="cmd_vel_out" to="cmd_vel"/>{}</node>'
    assert codes(tmp_path / "a", PAIR.format(mux.format("")), base="TwistStamped") == ["TARL302"]
    stamped = mux.format('<param name="use_stamped" value="true"/>')
    assert codes(tmp_path / "b", PAIR.format(stamped), base="TwistStamped") == []


def test_workspace_types_are_used_only_by_workspace_packages(tmp_path):
    (tmp_path / "robot/msg").mkdir(parents=True)
    (tmp_path / "robot/msg/Twist.msg").write_text("float64 speed\n")
    (tmp_path / "robot/launch").mkdir()
    (tmp_path / "robot/package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "robot/launch/r.launch").write_text(
        PAIR.format(
            NODE.format("unknown_driver", "node") + '<include file="$(find other)/a.launch"/>'
        ).strip()
    )
    for name, text in (("pilot", PILOT), ("base", BASE)):
        own = text.format(kind="Twist").replace("geometry_msgs", "robot")
        (tmp_path / f"robot/{name}.py").write_text("#!/usr/bin/env python3" + own)
    config = resolve(Options((tmp_path,), select=("TARL3",)))
    (system,) = systems(Request(ALL, (), (tmp_path,)), config)
    assert [one.code for one in hazards(system, config)] == ["TARL301"]


def node(package: str, executable: str, arguments: str = "", kind: str = "node") -> LaunchedNode:
    return LaunchedNode(package, executable, "n", "/", Path("a.launch"), 1, arguments=arguments, kind=kind)  # type: ignore[arg-type]


def test_nodelet_has_the_types_of_its_class_package():
    assert kinds(node("nodelet", "nodelet", "manager")) == frozenset()
    assert "Image" in (kinds(node("nodelet", "nodelet", "load image_proc/rectify m")) or ())
    assert "Image" in (kinds(node("image_proc", "image_proc::RectifyNode", kind="component")) or ())
    assert kinds(node("nodelet", "nodelet", "load other/Thing m")) is None
    assert kinds(node("other", "thing")) is None
    assert kinds(node("rclcpp_components", "component_container", kind="container")) == frozenset()


def test_fields_of_messages_are_read_from_their_definitions(tmp_path):
    text = """
    # a comment
    Header header
    geometry_msgs/Pose[] poses   # several
    geometry_msgs/Pose pose
    string<=20 label "x"
    float64[3] position
    Part part
    uint8 EMPTY=0
    """
    expected = {
        "header": "Header",
        "poses": "",
        "poses[]": "Pose",
        "pose": "Pose",
        "label": "",
        "position": "",
        "part": "robot/Part",
        "EMPTY": "",
    }
    assert parsed(text, "robot") == expected
    (tmp_path / "robot/msg").mkdir(parents=True)
    (tmp_path / "robot/package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "robot/msg/Whole.msg").write_text(text)
    (tmp_path / "robot/msg/Part.msg").write_text("Whole whole\nint8 x")
    found = fields(["robot/Whole", "robot/Missing", "other/Whole"], read(tmp_path))
    assert found == {"robot/Whole": expected, "robot/Part": {"whole": "robot/Whole", "x": ""}}


def test_multiplexer_inputs_are_in_its_parameters(tmp_path):
    mux = """<node pkg="twist_mux" type="twist_mux" name="mux"><rosparam>
      topics: [{{name: a, topic: {}, timeout: 0.5, priority: 1}}]
    </rosparam></node>"""
    pilot = '<launch><node pkg="robot" type="pilot.py" name="pilot"/>{}</launch>'
    assert codes(tmp_path / "a", pilot.format(mux.format("command_vel"))) == ["TARL301"]
    assert codes(tmp_path / "b", pilot.format(mux.format("cmd_vel"))) == []
    assert codes(tmp_path / "c", pilot.format(mux.format("joy_vel"))) == []
    unknown = mux.format("command_vel").replace("0.5", "0.5}, {{name: b")
    assert codes(tmp_path / "d", pilot.format(unknown.replace("{{", "{"))) == []


def test_ros2_multiplexer_inputs_are_nested_parameters():
    names = {"topics.joy.topic": "joy_vel", "topics.nav.topic": "nav_vel", "topics.nav.priority": 5}
    mux = Instance(node("twist_mux", "twist_mux"), "/mux")
    known = typed(mux, {**names, "locks.stop.topic": "e_stop", "use_stamped": False}, ros2=True)
    assert known.certain
    assert [(one.names[0], one.type) for one in known.ends if one.role == "subscribes"] == [
        ("joy_vel", "Twist"), ("nav_vel", "Twist"), ("e_stop", "Bool")
    ]  # fmt: skip
    assert not typed(mux, {**names, "locks.stop.topic": "$(var stop)"}, ros2=True).certain
    assert not typed(mux, {"topics": "all"}, ros2=True).certain


def test_ros2_multiplexer_type_depends_on_its_version():
    mux = Instance(node("twist_mux", "twist_mux"), "/mux")
    given: list[tuple[dict[str, object], bool, str]] = [
        ({}, False, "Twist"), ({}, True, ""), ({"use_stamped": True}, True, "TwistStamped"),
        ({"use_stamped": False}, True, "Twist"), ({"use_stamped": "$(var stamped)"}, True, ""),
    ]  # fmt: skip
    for values, ros2, kind in given:
        assert [one.type for one in typed(mux, values, ros2=ros2).ends] == [kind]


@pytest.mark.parametrize(
    ("include", "found"),
    [("$(find usb_cam)/launch/a.launch", ["TARL301"]), ("$(find amcl_maps)/launch/a.launch", []),
     ("$(find move_base)/launch/a.launch", [])],
)  # fmt: skip
def test_missing_launch_file_of_a_known_package_has_its_types(tmp_path, include, found):
    assert codes(tmp_path, PAIR.format(f'<include file="{include}"/>')) == found


UNNAMED = """#!/usr/bin/env python3
import sys
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool, {kind}
{imported}
rospy.init_node("other")
pub = rospy.Publisher(sys.stdin.readline(), {kind}, queue_size=1)
pub.publish()
"""


@pytest.mark.parametrize(
    ("kind", "imported", "found"),
    [
        ("Bool", "", ["TARL301"]),
        ("Twist", "", []),
        ("Bool", "import some_library", []),
        ("Other", "", ["TARL301"]),
    ],
)
def test_node_with_computed_names_uses_the_types_in_its_code(tmp_path, kind, imported, found):
    text = UNNAMED.format(kind="Bool" if kind == "Twist" else kind, imported=imported)
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot/other.py").write_text(text.replace("(), Bool,", f"(), {kind},"))
    assert codes(tmp_path, PAIR.format(NODE.format("robot", "other.py"))) == found
