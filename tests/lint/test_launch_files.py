"""Launch files are read as text: nodes with namespaces, remappings, parameters, and symbolic values."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from tarl_lint.workspace.launch_model import Launch
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.parameter_yaml import of_node
from tarl_lint.workspace.read import read


def launched(tmp_path: Path, text: str, name: str = "bringup.launch", **arguments: str) -> Launch:
    base = tmp_path / "arm_base"
    (base / "config").mkdir(parents=True, exist_ok=True)
    (base / "package.xml").write_text("<package><name>arm_base</name></package>")
    (base / "config/arm.yaml").write_text("kp: $(arg gain)\nlimits: {top: 3}\n")
    (base / "config/ros2.yaml").write_text("/**:\n  ros__parameters:\n    kp: 2.0\n")
    (base / "part.launch").write_text(
        '<launch><arg name="arm"/><arg name="rate" default="5"/>'
        '<node pkg="arm_base" type="part" name="part_$(arg arm)"><param name="rate" value="$(arg rate)"/></node>'
        "</launch>"
    )
    path = base / name
    path.write_text(dedent(text))
    workspace = read(tmp_path)
    return read_launch(path, workspace, arguments)


def settings(found: Launch, number: int = 0) -> list[tuple[str, object]]:
    known = [one for one in found.nodes[number].settings if not one.unknown]
    return [(one.name, one.yaml if one.value is None else one.value) for one in known]


def unknown(found: Launch) -> list[str]:
    return [one.name for node in found.nodes for one in node.settings if one.unknown]


ROS1 = """\
<launch>
  <arg name="gain" default="0.5"/>
  <arg name="robot"/>
  <arg name="twice" value="$(eval 2 * gain)"/>
  <param name="use_sim_time" value="true"/>
  <rosparam ns="shared" file="$(find arm_base)/config/arm.yaml" subst_value="true"/>
  <remap from="scan" to="/front/scan"/>
  <group ns="left" if="$(eval gain &lt; 1)">
    <param name="~speed" value="1"/>
    <remap from="odom" to="odometry"/>
    <node pkg="arm_base" type="drive" name="drive" ns="inner" args="--fast $(anon x)">
      <remap from="cmd" to="/cmd_vel"/>
      <param name="twice" value="$(arg twice)"/>
      <param name="label" type="str" value="7"/>
      <rosparam param="list">[1, 2]</rosparam>
      <param name="model" command="xacro $(find arm_base)/arm.xacro"/>
      <param name="who" value="$(arg robot)"/>
    </node>
  </group>
  <group unless="$(arg missing)"><node pkg="arm_base" type="watch" name="watch"/></group>
  <group unless="true"><node pkg="arm_base" type="never" name="never"/></group>
  <include file="$(dirname)/part.launch" ns="right"><arg name="arm" value="b"/></include>
  <include file="$(find elsewhere)/x.launch"/>
  <node pkg="arm_base" type="$(env KIND)" name="k"/>
</launch>
"""


def test_ros1_launch_files_are_read(tmp_path: Path) -> None:
    found = launched(tmp_path, ROS1)
    assert [(one.name, one.namespace, one.executable) for one in found.nodes] == [
        ("drive", "/left/inner", "drive"), ("watch", "/", "watch"), ("part_b", "/right", "part"),
        ("k", "/", "$(env KIND)"),
    ]  # fmt: skip
    assert [one.condition for one in found.nodes] == ["", "unless $(arg missing)", "", ""]
    drive = found.nodes[0]
    assert drive.remaps == (("scan", "/front/scan"), ("odom", "odometry"), ("cmd", "/cmd_vel"))
    assert (drive.arguments, drive.line) == ("--fast x", 11)
    assert settings(found) == [("~speed", 1), ("~twice", 1.0), ("~label", "7"), ("~list", "[1, 2]")]
    assert unknown(found) == ["~model", "~who"]
    assert [(one.name, one.value) for one in found.settings] == [("/use_sim_time", True), ("/shared", None)]
    assert found.settings[1].yaml == "kp: 0.5\nlimits: {top: 3}\n"
    assert settings(found, 2) == [("~rate", 5)]


def test_values_known_only_on_the_robot_are_reported(tmp_path: Path) -> None:
    assert [(one.line, one.reason) for one in launched(tmp_path, ROS1).problems] == [
        (16, "<param> of drive: ~model is what a command prints on the robot"),
        (17, "<param> of drive: the argument robot has no value"),
        (20, "unless of <group>: the argument missing has no value"),
        (23, "<include>: the package elsewhere is not in the workspace"),
        (24, "type of <node>: $(env KIND) is known on the robot only"),
    ]


def test_launch_arguments_override_defaults(tmp_path: Path) -> None:
    found = launched(tmp_path, ROS1, robot="husky", gain="2.0")
    assert [one.name for one in found.nodes] == ["watch", "part_b", "k"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<launch><node></launch>", "it is not XML"),
        ('<!DOCTYPE l [<!ENTITY a "b">]><launch/>', "it declares entities"),
        ('<launch><include file="$(dirname)/bringup.launch"/></launch>', "it includes itself"),
        ("<launch><param name='a' value='$(eval __import__(\"os\").getcwd())'/></launch>", "is not constant"),
    ],
)
def test_unreadable_files_are_reported(tmp_path: Path, text: str, reason: str) -> None:
    found = launched(tmp_path, text)
    assert not found.nodes
    assert any(reason in one.reason for one in found.problems)


ROS2 = """\
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node, PushRosNamespace
from launch_ros.substitutions import FindPackageShare

SIDES = ["left", "right"]


def generate_launch_description():
    share = get_package_share_directory("arm_base")
    gain = LaunchConfiguration("gain")
    files = PathJoinSubstitution([FindPackageShare("arm_base"), "config", "ros2.yaml"])
    ld = LaunchDescription([DeclareLaunchArgument("gain", default_value="0.5", description="how strong")])
    for side in SIDES:
        ld.add_action(GroupAction([
            PushRosNamespace(side),
            Node(package="arm_base", executable="drive", name=[side, "_drive"], remappings=[("cmd", "/cmd_vel")],
                 parameters=[files, {"kp": gain, "limits": {"top": 3}, "on": True}]),
        ]))
    ld.add_action(Node(package="arm_base", executable="watch", parameters=[os.path.join(share, "config/ros2.yaml"),
                                                                          {"home": os.environ["HOME"]}]))
    ld.add_action(OpaqueFunction(function=lambda context: []))
    return ld
"""


def test_ros2_launch_files_in_python_are_interpreted(tmp_path: Path) -> None:
    found = launched(tmp_path, ROS2, "bringup.launch.py")
    assert [(one.name, one.namespace, one.executable, one.remaps) for one in found.nodes] == [
        ("left_drive", "/left", "drive", (("cmd", "/cmd_vel"),)),
        ("right_drive", "/right", "drive", (("cmd", "/cmd_vel"),)),
        ("", "/", "watch", ()),
    ]
    yaml = "/**:\n  ros__parameters:\n    kp: 2.0\n"
    assert settings(found) == [("~", yaml), ("~kp", "0.5"), ("~limits.top", 3), ("~on", True)]
    assert settings(found, 2) == [("~", yaml)]
    assert {(one.line, one.reason) for one in found.problems} == {(23, "the parameter home is not constant")}


def test_a_self_referring_argument_terminates(tmp_path: Path) -> None:
    text = """
        from launch import LaunchDescription
        from launch.actions import DeclareLaunchArgument
        from launch.substitutions import LaunchConfiguration
        from launch_ros.actions import Node

        def generate_launch_description():
            ns = LaunchConfiguration("ns", default="a")
            return LaunchDescription([DeclareLaunchArgument("ns", default_value=ns),
                                      Node(package="arm_base", executable="drive", namespace=ns)])
    """
    assert [one.namespace for one in launched(tmp_path, text, "x.launch.py").nodes] == ["/a"]


COMPLETE = """\
from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, GroupAction, IncludeLaunchDescription, OpaqueFunction,
                            RegisterEventHandler, TimerAction)
from launch.conditions import IfCondition, UnlessCondition
from launch.event_handlers import OnProcessExit
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import (Command, EqualsSubstitution, LaunchConfiguration, PathJoinSubstitution,
                                  PythonExpression, TextSubstitution)
from launch_ros.actions import ComposableNodeContainer, Node, PushRosNamespace, SetParameter, SetRemap
from launch_ros.descriptions import ComposableNode, ParameterValue
from launch_ros.substitutions import FindPackageShare


def setup(context, side):
    if LaunchConfiguration("robot").perform(context) == "husky":
        return [Node(package="arm_base", executable="drive", name=side + "_" + context.launch_configurations["robot"])]


def generate_launch_description():
    robot = LaunchConfiguration("robot")
    include = IncludeLaunchDescription(
        PythonLaunchDescriptionSource(PathJoinSubstitution([FindPackageShare("arm_base"), "part.launch.py"])),
        launch_arguments={"arm": [TextSubstitution(text="left_"), robot]}.items(),
        condition=IfCondition(PythonExpression(["'", robot, "' == 'husky'"])))
    camera = ComposableNode(package="camera", plugin="camera::Driver", name="camera",
                            remappings=[("image", "/front/image")], parameters=[{"rate": 30}])
    return LaunchDescription([
        DeclareLaunchArgument("robot", default_value="husky"),
        DeclareLaunchArgument("serial"),
        GroupAction([PushRosNamespace(robot), SetRemap("scan", "/front/scan"), SetParameter("use_sim_time", True),
                     include]),
        OpaqueFunction(function=setup, args=["left"]),
        Node(package="arm_base", executable="never", condition=UnlessCondition(EqualsSubstitution(robot, "husky"))),
        Node(package="arm_base", executable="port", name=["port_", LaunchConfiguration("serial")],
             condition=IfCondition(LaunchConfiguration("serial")),
             parameters=[{"model": Command(["xacro ", "arm.xacro"]), "label": ParameterValue(robot, value_type=str)}]),
        ComposableNodeContainer(package="rclcpp_components", executable="component_container", name="box",
                                namespace="inner", composable_node_descriptions=[camera]),
        TimerAction(period=3.0, actions=[RegisterEventHandler(OnProcessExit(
            target_action=include, on_exit=[Node(package="arm_base", executable="after")]))]),
    ])
"""
PART = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
import launch_ros


def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument("arm"), launch_ros.actions.Node(
        package="arm_base", executable="part", name=LaunchConfiguration("arm"), remappings=[("a", "b")])])
"""


def test_python_files_may_use_includes_conditions_functions_and_components(tmp_path: Path) -> None:
    launched(tmp_path, PART, "part.launch.py")
    found = launched(tmp_path, COMPLETE, "bringup.launch.py")
    assert [(one.kind, one.name, one.namespace, one.executable) for one in found.nodes] == [
        ("node", "left_husky", "/husky", "part"),
        ("node", "left_husky", "/", "drive"),
        ("node", "port_$(var serial)", "/", "port"),
        ("container", "box", "/inner", "component_container"),
        ("component", "camera", "/", "camera::Driver"),
        ("node", "", "/", "after"),
    ]
    assert (found.nodes[0].remaps, found.nodes[0].file.name) == (
        (("scan", "/front/scan"), ("a", "b")),
        "part.launch.py",
    )
    assert settings(found) == [("~use_sim_time", True)]
    assert (settings(found, 2), found.nodes[2].condition) == ([("~label", "husky")], "$(var serial)")
    assert (found.nodes[4].remaps, settings(found, 4)) == ((("image", "/front/image"),), [("~rate", 30)])
    assert [(one.line, one.reason) for one in found.problems] == [
        (34, "the condition `$(var serial)` is known on the robot only"),
        (34, "the name of a node is known on the robot only: port_$(var serial)"),
        (34, "the parameter model is not constant"),
    ]


def test_arguments_decide_conditions_in_python_files(tmp_path: Path) -> None:
    found = launched(tmp_path, COMPLETE, "bringup.launch.py", robot="jackal", serial="false")
    assert [one.executable for one in found.nodes] == [
        "never",
        "component_container",
        "camera::Driver",
        "after",
    ]


XML2 = """\
<launch>
  <arg name="robot" default="husky"/>
  <let name="twice" value="$(eval '2 * 3')"/>
  <group>
    <push-ros-namespace namespace="$(var robot)"/>
    <set_remap from="scan" to="/front/scan"/>
    <include file="$(dirname)/part.launch.py"><arg name="arm" value="$(var robot)_arm"/></include>
    <node pkg="arm_base" exec="drive" name="drive" namespace="inner" args="--fast" if="$(equals $(var robot) husky)">
      <remap from="cmd" to="/cmd_vel"/>
      <param name="twice" value="$(var twice)"/>
      <param name="label" value="7" type="str"/>
      <param name="limits"><param name="top" value="3"/></param>
      <param from="$(find-pkg-share arm_base)/config/ros2.yaml"/>
    </node>
  </group>
  <node pkg="arm_base" exec="watch" name="watch_$(env SIDE)" unless="$(not true)"/>
  <node_container pkg="rclcpp_components" exec="component_container" name="box" namespace="">
    <composable_node pkg="camera" plugin="camera::Driver" name="camera">
      <remap from="image" to="/image"/>
    </composable_node>
  </node_container>
  <unknown_action/>
</launch>
"""
YAML2 = """\
launch:
- arg: {name: robot, default: husky}
- let: {name: twice, value: "$(eval '2 * 3')"}
- group:
  - push-ros-namespace: {namespace: $(var robot)}
  - set_remap: {from: scan, to: /front/scan}
  - include:
      file: $(dirname)/part.launch.py
      arg: [{name: arm, value: $(var robot)_arm}]
  - node:
      pkg: arm_base
      exec: drive
      name: drive
      namespace: inner
      args: --fast
      if: $(equals $(var robot) husky)
      remap: [{from: cmd, to: /cmd_vel}]
      param:
      - {name: twice, value: $(var twice)}
      - {name: label, value: "7", type: str}
      - {name: limits, param: [{name: top, value: 3}]}
      - {from: $(find-pkg-share arm_base)/config/ros2.yaml}
- node: {pkg: arm_base, exec: watch, name: "watch_$(env SIDE)", unless: $(not true)}
- node_container:
    pkg: rclcpp_components
    exec: component_container
    name: box
    namespace: ""
    composable_node:
    - {pkg: camera, plugin: "camera::Driver", name: camera, remap: [{from: image, to: /image}]}
- unknown_action: {a: b}
"""


@pytest.mark.parametrize(("name", "text"), [("b.launch.xml", XML2), ("b.launch.yaml", YAML2)])
def test_ros2_launch_files_in_xml_and_yaml_are_equivalent(tmp_path: Path, name: str, text: str) -> None:
    pytest.importorskip("yaml")
    launched(tmp_path, PART, "part.launch.py")
    found = launched(tmp_path, text, name)
    assert [(one.kind, one.name, one.namespace, one.executable) for one in found.nodes] == [
        ("node", "husky_arm", "/husky", "part"),
        ("node", "drive", "/husky/inner", "drive"),
        ("node", "watch_$(env SIDE)", "/", "watch"),
        ("container", "box", "/", "component_container"),
        ("component", "camera", "/", "camera::Driver"),
    ]
    drive = found.nodes[1]
    assert (drive.remaps, drive.arguments) == ((("scan", "/front/scan"), ("cmd", "/cmd_vel")), "--fast")
    yaml = "/**:\n  ros__parameters:\n    kp: 2.0\n"
    assert settings(found, 1) == [("~twice", "6"), ("~label", "7"), ("~limits.top", "3"), ("~", yaml)]
    assert found.nodes[4].remaps == (("image", "/image"),)
    assert [one.reason for one in found.problems] == [
        "the name of a node is known on the robot only: watch_$(env SIDE)",
        "<unknown_action> is not followed",
    ]


def test_names_known_only_on_the_robot_stay_symbolic(tmp_path: Path) -> None:
    text = """
        <launch>
          <arg name="robot"/>
          <group ns="$(arg robot)">
            <node pkg="arm_base" type="drive" name="drive"><remap from="odom" to="/$(arg robot)/odom"/></node>
          </group>
        </launch>
    """
    (node,) = launched(tmp_path, text).nodes
    assert (node.namespace, node.remaps) == ("/$(arg robot)", (("odom", "/$(arg robot)/odom"),))


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("x.launch.yaml", "launch: [a: {", "it is not YAML"),
        ("x.launch.py", "def generate_launch_description():\n    return 1\n", "returns nothing that can be followed"),
        ("x.launch.py", "import os\nos.system('touch /tmp/executed')\n", "returns nothing that can be followed"),
        ("x.launch.xml", '<launch><let name="a" value="b"/><include file="$(dirname)/x.launch.xml"/></launch>',
         "it includes itself"),
        ("x.launch.xml", '<launch><let name="a" value="b"/><include file="$(find-pkg-share nav)/x.xml"/></launch>',
         "the included file $(find-pkg-share nav)/x.xml is not in the workspace"),
    ],
)  # fmt: skip
def test_unreadable_ros2_files_are_reported(tmp_path: Path, name: str, text: str, reason: str) -> None:
    pytest.importorskip("yaml")
    found = launched(tmp_path, text, name)
    assert not found.nodes
    assert any(reason in one.reason for one in found.problems)


def test_ros1_node_parameters_are_private_unless_absolute(tmp_path: Path) -> None:
    text = """
        <launch><node pkg="arm_base" type="drive" name="drive">
          <param name="/gui" value="  words  "/>
          <rosparam param="/sources">[a]</rosparam>
          <rosparam param="list" ns="deep">[b]</rosparam>
          <rosparam subst_value="true">{known: 1, home: $(env HOME)}</rosparam>
        </node></launch>
    """
    found = launched(tmp_path, text)
    assert settings(found) == [("~gui", "words"), ("/sources", "[a]"), ("~deep/list", "[b]"),
                               ("~", "{known: 1, home: $(env HOME)}")]  # fmt: skip
    assert [one.reason for one in found.problems] == ["<rosparam>: $(env HOME) is known on the robot only"]


def test_arguments_of_ros1_nodes_remap_topics_and_set_parameters(tmp_path: Path) -> None:
    text = """<launch><remap from="odom" to="/odometry"/><group ns="g">
        <node pkg="arm_base" type="drive" name="drive"
        args="scan:=/$(env A)/scan --fast debug:=true out:=a-b.txt _rate:=5 __ns:=/other">
        <remap from="cmd" to="/cmd_vel"/></node></group></launch>"""
    (node,) = launched(tmp_path, text).nodes
    assert node.remaps == (("odom", "/odometry"), ("scan", "/$(env A)/scan"), ("cmd", "/cmd_vel"))
    assert node.inherited == 1
    assert node.namespace == "/other"
    assert [(one.name, one.yaml) for one in node.settings] == [("~rate", "5")]


def test_the_first_remapping_of_a_name_counts_in_ros2(tmp_path: Path) -> None:
    text = """<launch><set_remap from="/g/in" to="first"/>
        <node pkg="arm_base" exec="drive" name="drive" namespace="g" ros_args="-r other:in:=x -r drive:out:=mine">
        <remap from="in" to="second"/><remap from="out" to="late"/></node></launch>"""
    (node,) = launched(tmp_path, text, "x.launch.xml").nodes
    assert node.remaps == (("/g/in", "first"), ("out", "mine"))
    assert node.inherited == 1


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        (r"$(eval '\'$(var robot)\' == \'a\'')", True),
        (r"$(eval '\'$(var robot)\' == \'b\'')", False),
        ("$(eval 'pi > 3 and math.floor(2.5) == 2')", True),
    ],
)
def test_expressions_in_quotes_are_evaluated(tmp_path: Path, text: str, kept: bool) -> None:
    found = launched(
        tmp_path,
        f"""<launch><arg name="robot" default="a"/><node pkg="p" exec="e" if="{text}"/></launch>""",
        "x.launch.xml",
    )
    assert not found.problems
    assert bool(found.nodes) is kept


def test_parameter_sections_match_nodes_as_in_rclpy() -> None:
    yaml = pytest.importorskip("yaml")
    names = (
        "talker",
        "/talker",
        "ns/talker",
        "/ns/talker",
        "/**",
        "/**/talker",
        "/*/talker",
        "/ns/*",
        "/*",
        "**",
    )
    lines = "".join(f"{name!r}:\n  ros__parameters: {{{name!r}: 1}}\n" for name in names)
    parsed = yaml.safe_load(lines + "ns:\n  talker:\n    ros__parameters: {nested: 1}\n")
    everywhere = {"/**", "**", "/**/talker"}
    assert set(of_node(parsed, "/talker")) == {"talker", "/talker", "/*", *everywhere}
    assert set(of_node(parsed, "/ns/talker")) == {
        *("ns/talker", "/ns/talker", "/*/talker", "/ns/*", "nested"),
        *everywhere,
    }
    assert set(of_node(parsed, "/a/ns/talker")) == everywhere


def test_substitutions_of_navigation_2_are_interpreted(tmp_path: Path) -> None:
    text = """
        from launch import LaunchDescription
        from launch.actions import DeclareLaunchArgument
        from launch.conditions import IfCondition
        from launch.substitutions import PathJoinSubstitution, PythonExpression
        from launch_ros.actions import Node
        from launch_ros.substitutions import FindPackageShare
        from nav2_common.launch import LaunchConfigAsBool, RewrittenYaml

        def generate_launch_description():
            composed = LaunchConfigAsBool("composed")
            file = PathJoinSubstitution([FindPackageShare("arm_base"), "config", "ros2.yaml"])
            plain = RewrittenYaml(source_file=file, root_key="", param_rewrites={}, convert_types=True)
            changed = RewrittenYaml(source_file=file, param_rewrites={"kp": "3.0"})
            return LaunchDescription([
                DeclareLaunchArgument("composed", default_value="True"),
                Node(package="arm_base", executable="a", condition=IfCondition(PythonExpression(["not ", composed]))),
                Node(package="arm_base", executable="b", parameters=[plain, changed], condition=IfCondition(composed)),
            ])
    """
    found = launched(tmp_path, text, "x.launch.py")
    assert [one.executable for one in found.nodes] == ["b"]
    assert settings(found) == [("~", "/**:\n  ros__parameters:\n    kp: 2.0\n")]
    assert [one.reason for one in found.problems] == ["the parameter file $(RewrittenYaml) is not known here"]


def test_launch_file_can_use_another_file(tmp_path: Path) -> None:
    text = """
        from launch import LaunchDescription
        from launch.substitutions import AnySubstitution, FileContent
        from launch.conditions import IfCondition
        from launch_ros.actions import Node, RosTimer
        from launch_ros.substitutions import FindPackageShare
        import os

        def generate_launch_description():
            text = FileContent(os.path.join(FindPackageShare("arm_base").find("arm_base"), "config", "ros2.yaml"))
            return LaunchDescription([RosTimer(period=1.0, actions=[
                Node(package="arm_base", executable="a", condition=IfCondition(AnySubstitution("false", "true")),
                     parameters=[{"text": text, "other": FileContent("/etc/no")}])])])
    """
    found = launched(tmp_path, text, "x.launch.py")
    assert settings(found)[0][1] == "/**:\n  ros__parameters:\n    kp: 2.0\n"
    assert [one.reason for one in found.problems] == ["the parameter other is not constant"]


def test_anonymous_names_and_nodes_started_by_events_are_marked(tmp_path: Path) -> None:
    python = """
        from launch import LaunchDescription
        from launch.actions import RegisterEventHandler
        from launch.event_handlers import OnProcessExit
        from launch.substitutions import AnonName
        from launch_ros.actions import Node

        def generate_launch_description():
            first = Node(package="p", executable="a", name="first")
            again = RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[first]))
            return LaunchDescription([first, again, Node(package="p", executable="a", name=[AnonName("x"), "_y"])])
    """
    xml = '<launch><let name="a" value="b"/><node pkg="p" exec="e" name="$(anon x)"/></launch>'
    ros1 = """<launch><node pkg="p" type="e" name="$(anon x)"/><node pkg="p" type="e" name="$(anon x)"/>
        <node pkg="p" type="e" name="x"/><include file="$(dirname)/y.launch"/></launch>"""
    (tmp_path / "arm_base").mkdir()
    (tmp_path / "arm_base/y.launch").write_text('<launch><node pkg="p" type="e" name="$(anon x)"/></launch>')
    found = [launched(tmp_path, text, name).nodes for text, name in
             ((python, "x.launch.py"), (xml, "x.launch.xml"), (ros1, "x.launch"))]  # fmt: skip
    assert [[(one.name, one.anonymous, one.event) for one in nodes] for nodes in found] == [
        [("first", "", False), ("first", "", True), ("x_y", "anon", False)],
        [("x", "anon", False)],
        [("x", "file 0", False), ("x", "file 0", False), ("x", "", False), ("x", "file 1", False)],
    ]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "bringup.launch.py",
            """
            from launch import LaunchDescription
            from launch.actions import DeclareLaunchArgument
            from launch.substitutions import LaunchConfiguration
            from launch_ros.actions import Node

            def generate_launch_description():
                world = LaunchConfiguration("world")
                return LaunchDescription([
                    DeclareLaunchArgument("world", default_value=""),
                    Node(package="sim", executable="create", parameters=[{"world": world}]),
                ])
            """,
        ),
        (
            "bringup.launch.xml",
            """
            <launch>
              <arg name="world" default=""/>
              <node pkg="sim" exec="create"><param name="world" value="$(var world)"/></node>
            </launch>
            """,
        ),
    ],
)
def test_an_empty_parameter_is_an_empty_text(tmp_path: Path, name: str, text: str) -> None:
    found = launched(tmp_path, text, name)

    assert [(one.name, one.value, one.yaml) for one in found.nodes[0].settings] == [("~world", "", None)]


def test_content_of_a_non_text_file_is_unknown(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        <launch>
          <node pkg="arm_base" type="part" name="part">
            <param name="table" binfile="$(find arm_base)/config/arm.yaml"/>
          </node>
        </launch>
        """)  # fmt: skip

    assert unknown(found) == ["~table"]
    assert [one.reason for one in found.problems] == [
        "<param> of part: ~table is the content of a file that is not text"
    ]
