"""Bridges between ROS 2 and Gazebo: their topics stand in arguments and in YAML files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.lint.test_system import MANIFEST, flows, run, write

PILOT = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Pilot(Node):
    def __init__(self):
        super().__init__("pilot")
        self.out = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)

    def on_scan(self, scan):
        command = Twist()
        command.linear.x = min(scan.ranges)
        self.out.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Pilot())
"""
SETUP = """\
from setuptools import setup
setup(name="cart", packages=["cart"], entry_points={"console_scripts": ["pilot = cart.pilot:main"]})
"""
BRIDGE = '<node pkg="ros_gz_bridge" exec="parameter_bridge" name="b" args="{}"/>'
START = '<node pkg="cart" exec="pilot"/>'
SCAN, CMD = (
    "/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan",
    "/cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist",
)


@pytest.fixture
def cart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a workspace with one node from `scan` to `cmd_vel`."""
    monkeypatch.chdir(tmp_path)
    return write(tmp_path, {
        "cart/package.xml": MANIFEST.format("cart", "ament_python"),
        "cart/setup.py": SETUP,
        "cart/cart/__init__.py": "",
        "cart/cart/pilot.py": PILOT,
    })  # fmt: skip


def launched(folder: Path, body: str, name: str = "a.launch.xml") -> str:
    text = body if name.endswith(".py") else f"<launch>{body}</launch>"
    write(folder, {f"cart/launch/{name}": text})
    return str(folder / "cart/launch" / name)


def bridge(capsys: pytest.CaptureFixture[str], file: str) -> dict[str, Any]:
    _, out, _ = run(capsys, "--launch", file, "--format", "json")
    nodes = json.loads(out)["systems"][0]["nodes"]
    found: dict[str, Any] = next(
        one for one in nodes if "bridge" in one["package"] or "image" in one["package"]
    )
    return found


def ends(node: dict[str, Any]) -> tuple[list[tuple[str, str]], ...]:
    """Return what a node subscribes to, publishes and serves, with types."""
    return tuple(
        [(one["name"], one["type"]) for one in node[role]] for role in ("subscribes", "publishes", "serves")
    )


@pytest.mark.parametrize(
    ("arguments", "subscribed", "published", "served"),
    [
        (SCAN, [], [("/scan", "LaserScan")], []),
        (CMD, [("/cmd_vel", "Twist")], [], []),
        ("imu@sensor_msgs/Imu@gz.msgs.IMU", [("/imu", "Imu")], [("/imu", "Imu")], []),
        (f"{SCAN} {CMD}", [("/cmd_vel", "Twist")], [("/scan", "LaserScan")], []),
        (
            "/world/w/control@ros_gz_interfaces/srv/ControlWorld",
            [],
            [],
            [("/world/w/control", "ControlWorld")],
        ),
        (
            "/c@ros_gz_interfaces/srv/ControlWorld@gz.msgs.WorldControl@gz.msgs.Boolean",
            [],
            [],
            [("/c", "ControlWorld")],
        ),
        (f"{SCAN} --ros-args -r /scan:=/front", [], [("/front", "LaserScan")], []),
        (f"$(env TOPIC)@a/msg/B[c.d {CMD}", [("/cmd_vel", "Twist")], [], []),
        ("/scan@sensor_msgs/msg/LaserScan /x @a/b[c /y@a/b[", [], [], []),
        ("", [], [], []),
    ],
)
def test_the_arguments_of_a_parameter_bridge_are_its_topics(
    cart, capsys, arguments, subscribed, published, served
):
    assert ends(bridge(capsys, launched(cart, BRIDGE.format(arguments)))) == (subscribed, published, served)


CONFIG = """\
- ros_topic_name: "scan"
  gz_topic_name: "/world/w/scan"
  ros_type_name: "sensor_msgs/msg/LaserScan"
  gz_type_name: "gz.msgs.LaserScan"
  direction: GZ_TO_ROS
- topic_name: "/cmd_vel"
  ros_type_name: "geometry_msgs/msg/Twist"
  gz_type_name: "gz.msgs.Twist"
  direction: ROS_TO_GZ
- gz_topic_name: "both"
  ros_type_name: "std_msgs/msg/String"
  gz_type_name: "gz.msgs.StringMsg"
- topic_name: "a"
  ros_topic_name: "b"
  ros_type_name: "std_msgs/msg/String"
- topic_name: "no_type"
- topic_name: "elsewhere"
  ros_type_name: "std_msgs/msg/String"
  direction: SIDEWAYS
- 5
"""
FROM_PYTHON = """\
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node
from ros_gz_bridge.actions import RosGzBridge

PATH = get_package_share_directory("cart") + "/config/bridge.yaml"

def generate_launch_description():
    return LaunchDescription([{}])
"""


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.launch.xml", """<node pkg="ros_gz_bridge" exec="parameter_bridge" name="b" namespace="r">
            <param name="config_file" value="$(find-pkg-share cart)/config/bridge.yaml"/></node>"""),
        ("a.launch.xml", """<node pkg="ros_gz_bridge" exec="bridge_node" name="b" namespace="r"
            args="--ros-args -p config_file:=$(find-pkg-share cart)/config/bridge.yaml"/>"""),
        ("a.launch.xml", """<ros_gz_bridge bridge_name="b" namespace="r"
            config_file="$(find-pkg-share cart)/config/bridge.yaml"/>"""),
        ("a.launch.xml", """<include file="$(find-pkg-share ros_gz_bridge)/launch/ros_gz_bridge.launch.py">
            <arg name="bridge_name" value="b"/><arg name="namespace" value="r"/>
            <arg name="config_file" value="$(find-pkg-share cart)/config/bridge.yaml"/></include>"""),
        ("a.launch.xml", """<node_container pkg="rclcpp_components" exec="component_container" name="c">
            <composable_node pkg="ros_gz_bridge" plugin="ros_gz_bridge::RosGzBridge" name="b" namespace="r">
            <param name="config_file" value="$(find-pkg-share cart)/config/bridge.yaml"/></composable_node>
            </node_container>"""),
        ("a.launch.py", FROM_PYTHON.format('RosGzBridge(bridge_name="b", config_file=PATH, namespace="r")')),
        ("a.launch.py", FROM_PYTHON.format(
            'Node(package="ros_gz_bridge", executable="parameter_bridge", name="b", namespace="r",'
            ' parameters=[{"config_file": PATH}])')),
    ],
)  # fmt: skip
def test_the_yaml_file_of_a_bridge_has_its_topics(cart, capsys, name, text):
    write(cart, {"cart/config/bridge.yaml": CONFIG})
    node = bridge(capsys, launched(cart, text, name))
    assert node["name"] == "/r/b"
    assert ends(node) == (
        [("/cmd_vel", "Twist"), ("/r/both", "String")],
        [("/r/scan", "LaserScan"), ("/r/both", "String")],
        [],
    )


@pytest.mark.parametrize("text", ["- [", "5", "a: b"])
def test_damaged_bridge_file_has_no_topics(cart, capsys, text):
    write(cart, {"cart/config/bridge.yaml": text})
    file = launched(cart, """<node pkg="ros_gz_bridge" exec="parameter_bridge" name="b">
        <param name="config_file" value="$(find-pkg-share cart)/config/bridge.yaml"/></node>""")  # fmt: skip
    assert ends(bridge(capsys, file)) == ([], [], [])


def test_yaml_file_outside_the_workspace_is_not_read(cart, capsys, tmp_path_factory):
    other = tmp_path_factory.mktemp("elsewhere") / "bridge.yaml"
    other.write_text(CONFIG)
    file = launched(cart, f"""<node pkg="ros_gz_bridge" exec="parameter_bridge" name="b">
        <param name="config_file" value="{other}"/></node>""")  # fmt: skip
    assert ends(bridge(capsys, file)) == ([], [], [])


def test_an_image_bridge_publishes_the_transports_of_its_images(cart, capsys):
    file = launched(cart, '<node pkg="ros_gz_image" exec="image_bridge" args="/cam"/>')
    node = bridge(capsys, file)
    assert node["name"] == "/ros_gz_image"
    assert [name for name, _ in ends(node)[1]] == ["/cam", "/cam/compressed"]


def test_nothing_flows_through_the_simulator(cart, capsys):
    _, out, _ = run(capsys, "--launch", launched(cart, BRIDGE.format(f"{SCAN} {CMD}") + START))
    assert flows(out) == ["/scan → /pilot → /cmd_vel  explicit"]
    assert "Hazards" not in out


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (f"{SCAN} {CMD}", ""),
        (f"{SCAN} {CMD.replace('msg/Twist]', 'msg/TwistStamped]')}", "TARL302"),
        (f"{SCAN} {CMD.replace('/cmd_vel', '/model/cart/cmd_vel')}", "TARL301"),
        (f"{SCAN} {CMD.replace('/cmd_vel', '/model/cart/cmd_vel').replace(']', '@')}", ""),
        (f"{SCAN} {CMD} /odom@nav_msgs/msg/Odometry[gz.msgs.Odometry", ""),
        (f"$(env SCAN)@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan {CMD}", ""),
        (f"{SCAN.replace('[', '@')} {CMD.replace(']', '@')}", ""),
    ],
)
def test_rules_of_architecture_know_the_topics_of_a_bridge(cart, capsys, arguments, code):
    _, out, _ = run(capsys, "--launch", launched(cart, BRIDGE.format(arguments) + START))
    assert [word for word in out.split() if word.startswith("TARL3")] == ([code] if code else [])


def test_a_remapping_that_no_bridged_topic_has_is_reported(cart, capsys):
    node = BRIDGE.format(f"{SCAN} {CMD}").replace("/>", "><remap from='/lidar' to='/front'/></node>")
    _, out, _ = run(capsys, "--launch", launched(cart, node + START))
    assert "TARL308 /b uses no name /lidar" in out


@pytest.mark.parametrize(
    "place", ["", '<include file="$(find-pkg-share other)/launch/x.launch.py"/>', "<unknown/>"]
)
def test_unread_file_may_start_a_missing_publisher(cart, capsys, place):
    wrong = CMD.replace("/cmd_vel", "/model/cart/cmd_vel")
    _, out, _ = run(capsys, "--launch", launched(cart, BRIDGE.format(f"{SCAN} {wrong}") + START + place))
    assert ("TARL301" in out) is not bool(place)


def test_incomplete_arguments_allow_no_conclusion(cart, capsys):
    text = """
        from launch import LaunchDescription
        from launch_ros.actions import Node

        def generate_launch_description():
            names = ["/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"]
            for one in {loop}:
                names.append(one + "@std_msgs/msg/String[gz.msgs.StringMsg")
            return LaunchDescription([Node(package="ros_gz_bridge", executable="parameter_bridge", name="b",
                                           arguments=names, remappings=[("/lidar", "/front")])])
        """
    found = [run(capsys, "--launch", launched(cart, text.replace("{loop}", loop), f"{number}.launch.py"))[1]
             for number, loop in enumerate(('["/a"]', "absent()"))]  # fmt: skip
    assert ["TARL308" in out for out in found] == [True, False]
    assert all("/scan" in out for out in found)
