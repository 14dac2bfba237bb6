"""Tests of whole launch files: names, parameters, nodes that are not Python, and messages for mistakes."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl import Sensor
from pytest_tarl.episode import Tarl
from pytest_tarl.errors import NodeError, SettingsError
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.ros import message_type
from pytest_tarl.ros.launch_plan import launch_path
from pytest_tarl.ros.launched import texts_replaced
from pytest_tarl.ros.messages import node_workspaces
from tests.lint.test_system import MANIFEST
from tests.plugin.ros.test_workspaces import write

ROSPY = """
    #!/usr/bin/env python3
    import rospy
    from std_msgs.msg import Float64
    from utils import FACTOR
    rospy.init_node("own_name", argv=None)
    gain = rospy.get_param("~gain", 1.0) * rospy.get_param("mass", 1.0) * FACTOR
    out = rospy.Publisher("out", Float64, queue_size=1)
    rospy.Subscriber("in", Float64, lambda heard: out.publish(gain * heard.data))
    rospy.spin()
    """
RCLPY = """
    import rclpy
    from rclpy.node import Node
    from std_msgs.msg import Float64
    COUNT = []

    class Relay(Node):
        def __init__(self):
            super().__init__("relay")
            self.gain = self.declare_parameter("gain", 1.0).value
            self.limit = self.declare_parameter("limits.top", 100.0).value
            self.out = self.create_publisher(Float64, "out", 10)
            self.create_subscription(Float64, "in", self.on_in, 10)

        def on_in(self, heard):
            COUNT.append(1)
            from relays.late import share
            value = share(self.get_fully_qualified_name(), heard.data)
            self.out.publish(Float64(data=min(self.limit, self.gain * value) + 0.001 * len(COUNT)))

    def main():
        rclpy.init()
        rclpy.spin(Relay())
    """
LATE = """
    NAMES = set()
    def share(name, value):
        NAMES.add(name)
        assert NAMES == {name}, f"two nodes share one module: {NAMES}"
        return value
    """
FILES = {
    ".git/HEAD": "",
    "one/package.xml": "<package><name>one</name><depend>catkin</depend></package>",
    "one/CMakeLists.txt": "catkin_install_python(PROGRAMS scripts/relay.py)",
    "one/scripts/relay.py": ROSPY,
    "one/scripts/utils.py": "FACTOR = 1.0\n",
    "other/package.xml": "<package><name>other</name><depend>catkin</depend></package>",
    "other/CMakeLists.txt": "catkin_install_python(PROGRAMS scripts/double.py)",
    "other/scripts/double.py": ROSPY,
    "other/scripts/utils.py": "FACTOR = 2.0\n",
    "one/config/gains.yaml": "gain: 3.0\n",
    "one/launch/robot.launch": """
        <launch>
          <arg name="robot" default="r1"/>
          <arg name="camera" default="false"/>
          <arg name="camera_ns"/>
          <group ns="$(arg robot)">
            <param name="mass" value="10.0"/>
            <node pkg="one" type="relay.py" name="first">
              <remap from="in" to="start"/><remap from="out" to="middle"/>
              <rosparam file="$(find one)/config/gains.yaml"/>
            </node>
            <node pkg="other" type="double.py" name="second">
              <remap from="in" to="middle"/><remap from="out" to="/end"/>
              <param name="gain" value="0.5"/>
            </node>
            <node pkg="sick" type="driver" name="laser"><remap from="scan" to="start"/>
              <param name="rate" value="5"/></node>
          </group>
          <node pkg="one" type="relay.py" name="camera" ns="$(arg camera_ns)" if="$(arg camera)"/>
        </launch>
        """,
    "relays/package.xml": MANIFEST.format("relays", "ament_python"),
    "relays/setup.py": """
        from setuptools import setup
        setup(name="relays", packages=["relays"],
              entry_points={"console_scripts": ["relay = relays.relay:main", "lost = relays.lost:main"]})
        """,
    "relays/relays/__init__.py": "",
    "relays/relays/relay.py": RCLPY,
    "relays/relays/late.py": LATE,
    "relays/relays/lost.py": "import controllers\ndef main(): pass\n",
    "controllers/package.xml": "<package><name>controllers</name></package>",
    "relays/config/top.yaml": """
        /**: {ros__parameters: {limits: {top: 4.0}}}
        /r2/left: {ros__parameters: {gain: 2.0}}
        """,
    "relays/launch/pair.launch.xml": """
        <launch>
          <arg name="robot"/>
          <push-ros-namespace namespace="$(var robot)"/>
          <node pkg="relays" exec="relay" name="left">
            <remap from="in" to="/start"/><remap from="out" to="middle"/>
            <param from="$(find-pkg-share relays)/config/top.yaml"/>
          </node>
          <node pkg="relays" exec="relay"><remap from="in" to="middle"/><remap from="out" to="/end"/></node>
        </launch>
        """,
    "relays/launch/pair.launch.yaml": """
        launch:
        - node: {pkg: relays, exec: relay, name: left, remap: [{from: in, to: start}, {from: out, to: end}]}
        """,
    "relays/launch/pair.launch.py": """
        from launch import LaunchDescription
        from launch_ros.actions import Node
        def generate_launch_description():
            return LaunchDescription([Node(package="relays", executable="relay", namespace="r3",
                parameters=[{"gain": 7.0}], remappings=[("in", "/start"), ("out", "/end")])])
        """,
    "relays/launch/lost.launch.xml": '<launch><node pkg="relays" exec="lost" name="lost"/></launch>',
    "relays/launch/empty.launch.xml": "<launch/>",
}


@pytest.fixture
def tarl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Tarl]:
    """Open an episode in a workspace of four packages; forget the workspace at the end."""
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    write(tmp_path, {name: text.lstrip("\n") for name, text in FILES.items()})
    node_workspaces.forget()
    recorder = Recorder()
    sensors = [Sensor("x", low=0, high=1, bins=2)]
    with closing(Tarl(1, sensors, tmp_path, recorder, NodeImports(tmp_path, {}, recorder.hook))) as episode:
        yield episode
    node_workspaces.forget()
    assert "utils" not in sys.modules
    assert "relays.late" not in sys.modules


def sent(tarl: Tarl, topic: str, *values: float) -> Any:
    for value in values:
        tarl.bus.publish(topic, message_type("std_msgs/msg/Float64")(data=value))
        tarl.step(0.1)
    return getattr(tarl.bus.latest("/end"), "data", None)


def test_each_ros1_node_has_its_own_modules(tarl: Tarl) -> None:
    tarl.launch("one/launch/robot.launch")
    assert sent(tarl, "/r1/start", 1.0) == 3.0 * 10.0 * (0.5 * 10.0 * 2.0)
    assert tarl.ros.subscribed >= {"/r1/start", "/r1/middle"}
    (note,) = tarl.ros.notes
    assert note == (
        "robot.launch also starts nodes that did not run because they are not Python nodes of the workspace: /r1/laser "
        "(the package sick is not in the workspace). A function of the test can replace it: "
        'tarl.launch(…, replace={"laser": function}).'
    )


def test_a_note_names_nodes_that_have_the_same_name(tarl: Tarl, tmp_path: Path) -> None:
    node = '<node pkg="one" type="relay.py" name="same"/>'
    write(tmp_path, {"one/launch/twice.launch": f"<launch>{node}{node}</launch>"})
    tarl.launch("twice.launch")
    (note,) = tarl.ros.notes
    assert note == "twice.launch starts several nodes named /same: roslaunch refuses the file."


def test_nodes_that_exclude_each_other_are_never_started_together(tarl: Tarl, tmp_path: Path) -> None:
    node = '<node pkg="one" type="relay.py" name="{}" {}="$(arg sim)"/>'
    nodes = node.format("driver", "if") + node.format("driver", "unless") + node.format("other", "if")
    write(tmp_path, {"one/launch/either.launch": f'<launch><arg name="sim"/>{nodes}</launch>'})
    with pytest.raises(SettingsError) as raised:
        tarl.launch("either.launch")
    assert str(raised.value) == (
        "tarl.launch: either.launch starts either /driver (if $(arg sim)) or /driver (unless $(arg sim)): "
        'pass arguments={"sim": …}, or choose one of them with only=[…].'
    )
    tarl.launch("either.launch", arguments={"sim": "true"})
    assert tarl.ros.notes == ()


def test_test_tags_of_a_launch_file_are_not_started(tarl: Tarl, tmp_path: Path) -> None:
    node = '<node pkg="one" type="relay.py" name="relay"/>'
    checked = '<remap from="out" to="/checked"/>'
    test = f'<test pkg="one" type="relay.py" test-name="check">{checked}</test>'
    write(tmp_path, {"one/test/relay.test": f"<launch>{node}{test}</launch>"})
    node_workspaces.forget()
    tarl.launch("one/relay.test")
    assert sent(tarl, "/in", 1.0) is None
    assert tarl.bus.latest("/out").data == 1.0
    assert tarl.bus.latest("/checked") is None
    assert tarl.ros.notes == ()


def test_hidden_node_runs_with_a_note(tarl: Tarl, tmp_path: Path) -> None:
    write(tmp_path, {"other/CATKIN_IGNORE": ""})
    node_workspaces.forget()
    tarl.launch("one/launch/robot.launch", only=["first", "second"])
    assert sent(tarl, "/r1/start", 1.0) == 3.0 * 10.0 * (0.5 * 10.0 * 2.0)
    (note,) = tarl.ros.notes
    assert "other/CATKIN_IGNORE: the file hides the package other from ROS" in note


def test_launch_arguments_and_selected_nodes_are_respected(tarl: Tarl) -> None:
    tarl.launch("robot.launch", arguments={"robot": "husky"}, only=["first"], parameters={"gain": 1.0})
    assert sent(tarl, "/husky/start", 2.0) is None
    assert tarl.bus.latest("/husky/middle").data == 2.0 * 10.0
    assert tarl.ros.notes == ()


def test_test_function_replaces_a_node(tarl: Tarl) -> None:
    heard = []

    def laser(node: Any) -> None:
        assert (node.name, node.resolve("scan"), node.parameter("rate"), node.parameter("x", 1)) == (
            "/r1/laser", "/r1/start", 5, 1)  # fmt: skip
        node.every(0.2, lambda: node.publish("scan", message_type("std_msgs/Float64")(1.0)))
        node.subscribe("/end", lambda message: heard.append((round(tarl.now, 3), message.data)))

    tarl.launch("one/robot.launch", replace={"/r1/laser": laser})
    for _ in range(5):
        tarl.step(0.1)
    assert heard == [(0.0, 300.0), (0.2, 300.0), (0.4, 300.0)]


def test_replaced_nodes_need_not_be_named_in_only(tarl: Tarl) -> None:
    def laser(node: Any) -> None:
        node.every(0.2, lambda: node.publish("scan", message_type("std_msgs/Float64")(1.0)))

    tarl.launch("robot.launch", only=["first"], replace={"laser": laser})
    tarl.step(0.1)
    assert tarl.bus.latest("/r1/middle").data == 30.0
    assert tarl.bus.latest("/end") is None


def test_errors_of_a_function_node_are_errors_of_the_test(tarl: Tarl) -> None:
    def second(node: Any) -> None:
        node.every(1.0, lambda: 1 / 0)

    tarl.launch("robot.launch", replace={"second": second, "laser": lambda node: None})
    with pytest.raises(ZeroDivisionError):
        tarl.step(0.1)


def test_two_nodes_of_a_program_do_not_share_modules(tarl: Tarl) -> None:
    tarl.launch("relays/launch/pair.launch.xml", arguments={"robot": "r2"})
    # the left node gets gain 2 and top 4 from YAML; no section names the other node, which keeps its defaults
    assert sent(tarl, "/start", 1.0, 3.0) == pytest.approx(4.0 + 2 * 0.002)
    assert tarl.ros.subscribed >= {"/start", "/r2/middle"}


@pytest.mark.parametrize(
    ("file", "topic", "end"), [("pair.launch.yaml", "/start", 2.001), ("pair.launch.py", "/start", 14.001)]
)
def test_ros2_launch_files_in_yaml_and_python_start_nodes(
    tarl: Tarl, file: str, topic: str, end: float
) -> None:
    tarl.launch(file)
    assert sent(tarl, topic, 2.0) == pytest.approx(end)


def test_edited_parameter_files_are_read_again(tarl: Tarl, tmp_path: Path) -> None:
    tarl.launch("robot.launch", only=["first"])
    write(tmp_path, {"one/config/gains.yaml": "gain: 5.0\n"})
    with texts_replaced():
        tarl.launch("robot.launch", arguments={"robot": "r2"}, only=["first"])
    sent(tarl, "/r2/start", 1.0)
    assert tarl.bus.latest("/r2/middle").data == 50.0


@pytest.mark.parametrize(
    ("file", "options", "said"),
    [
        ("robots.launch", {}, r"robots\.launch: no such file, .* Did you mean robot\.launch\?"),
        ("robot.launch", {"arguments": {"robt": 1}}, r"robot\.launch has no argument 'robt'; did you mean 'robot'\?"),
        ("robot.launch", {"arguments": {"x": 1}}, r"has no argument 'x'; it has camera, camera_ns, robot\."),
        ("pair.launch.py", {"arguments": {"x": 1}}, r"has no argument 'x'; it has none\."),
        ("robot.launch", {"only": ["frist"]}, (r"only names 'frist', but robot\.launch starts no such node\. "
         r"Did you mean 'first'\? It starts /r1/first, /r1/second, /r1/laser\.")),
        ("robot.launch", {"replace": {"lidar": print}}, r"replace names 'lidar', but robot\.launch starts no such"),
        ("robot.launch", {"only": ["laser"]}, r"only names /r1/laser, which is not a Python node of the workspace \("),
        ("robot.launch", {"only": []}, r"only=\[\] leaves no node of robot\.launch to start"),
        ("robot.launch", {"only": "first"}, r'only takes a list of node names, such as only=\["first"\]'),
        ("robot.launch", {"replace": {"laser": 5}}, "replace takes a function for each node, but laser has 5"),
        ("robot.launch", {"arguments": ["camera"]}, r"arguments takes a mapping, not \['camera'\]"),
        ("robot.launch", {"parameters": ["gain"]}, r"a mapping or the path of a YAML file, not \['gain'\]"),
        ("robot.launch", {"arguments": {"camera": True}}, (r"the node /\$\(arg camera_ns\)/camera .*depends on "
         r"'/\$\(arg camera_ns\)', which has no value here: pass arguments=\{\"camera_ns\": …\}")),
        ("pair.launch.xml", {}, r"depends on '/\$\(var robot\)', .* pass arguments=\{\"robot\": …\}"),
        ("empty.launch.xml", {}, r"empty\.launch\.xml starts no node with these arguments"),
    ],
)  # fmt: skip
def test_user_mistakes_are_reported_in_one_sentence(
    tarl: Tarl, file: str, options: dict[str, Any], said: str
) -> None:
    with pytest.raises(SettingsError, match=said):
        tarl.launch(file, **options)


def test_unknown_import_is_reported_in_one_sentence(tarl: Tarl, tmp_path: Path) -> None:
    with pytest.raises(
        NodeError, match=r"No module named 'controllers' .*The package controllers is in the works"
    ):
        tarl.launch("lost.launch.xml")
    write(tmp_path, {"relays/relays/lost.py": "import nonesuch\ndef main(): pass\n"})
    with pytest.raises(
        NodeError, match=r"No package of the workspace .* installs nonesuch, and it is not installed"
    ):
        tarl.launch("lost.launch.xml")


def test_launch_file_beside_the_test_is_found_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_workspaces, "_SEARCHED", [])
    launch = '<launch><node pkg="bot" exec="relay"/></launch>'
    write(
        tmp_path,
        {"bot/package.xml": MANIFEST.format("bot", "ament_python"), "bot/launch/go.launch.xml": launch},
    )
    for name in ("go.launch.xml", "bot/go.launch.xml"):
        assert launch_path(name, tmp_path) == tmp_path / "bot" / "launch" / "go.launch.xml"
    (tmp_path / "empty").mkdir()
    with pytest.raises(
        SettingsError, match=r"go\.launch: no such file in .*, which is not in a ROS workspace"
    ):
        launch_path("go.launch", tmp_path / "empty")


def test_a_marker_may_name_a_launch_file(tarl: Tarl, tmp_path: Path) -> None:
    from pytest_tarl.starting import node_files

    nodes = node_files(["robot.launch", "more.py"], tmp_path, "test_it.py::test_it")
    assert nodes == ("one/scripts/relay.py", "other/scripts/double.py", "more.py")
    with pytest.raises(SettingsError, match=r"test_it: nodes: none\.launch: no such file"):
        node_files(["none.launch"], tmp_path, "test_it")
    write(tmp_path, {"a.launch": '<launch><node pkg="sick" type="driver" name="laser"/></launch>'})
    with pytest.raises(SettingsError, match=r"the launch file a\.launch in nodes starts no Python node"):
        node_files(["a.launch"], tmp_path, "test_it")
