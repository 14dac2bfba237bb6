"""urdf_parser_py: robot descriptions. The expected values are those of urdf_parser_py 0.0.4 for the same text."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

from pytest_tarl.ros.urdf_parser.elements import ParseError
from pytest_tarl.ros.urdf_parser.urdf import URDF, Box, Cylinder, Joint, Link, Mesh, Robot, Sphere
from tests.plugin.ros.conftest import Start, heard

bare = pytest.mark.skipif(
    importlib.util.find_spec("urdf_parser_py") is not None, reason="a urdf_parser_py is installed here"
)

ARM = """<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.1"/><mass value="1.5"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"/>
    </inertial>
    <visual>
      <origin xyz="0 0 0.2" rpy="0 0.1 0"/><geometry><cylinder radius="0.05" length="0.4"/></geometry>
      <material name="grey"/>
    </visual>
    <collision><geometry><box size="0.1 0.2 0.4"/></geometry></collision>
  </link>
  <link name="tool">
    <visual><geometry><mesh filename="package://arm/tool.stl" scale="0.001 0.001 0.001"/></geometry></visual>
  </link>
  <link name="finger"><visual><geometry><sphere radius="0.01"/></geometry></visual></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0 0 1.57"/><axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.6" effort="10" velocity="2"/><dynamics damping="0.1"/>
    <safety_controller k_velocity="3" k_position="4" soft_lower_limit="-1.4" soft_upper_limit="1.5"/>
    <calibration rising="0.1"/>
  </joint>
  <joint name="wrist" type="fixed"><parent link="upper"/><child link="tool"/></joint>
  <joint name="grip" type="prismatic">
    <parent link="tool"/><child link="finger"/><limit effort="1" velocity="1"/>
    <mimic joint="shoulder" multiplier="-1" offset="0.5"/>
  </joint>
</robot>"""


@pytest.fixture
def arm() -> Any:
    return URDF.from_xml_string(ARM)


def test_links_and_joints_form_a_tree(arm: Any) -> None:
    assert (arm.name, arm.version, arm.get_root()) == ("arm", "1.0", "base")
    assert arm.parent_map == {
        "upper": ("shoulder", "base"),
        "tool": ("wrist", "upper"),
        "finger": ("grip", "tool"),
    }
    assert arm.child_map == {
        "base": [("shoulder", "upper")],
        "upper": [("wrist", "tool")],
        "tool": [("grip", "finger")],
    }
    assert arm.joint_map["grip"] is arm.joints[2]
    assert arm.link_map["tool"] is arm.links[2]


def test_chains_run_from_root_to_tip(arm: Any) -> None:
    whole = ["base", "shoulder", "upper", "wrist", "tool", "grip", "finger"]
    assert arm.get_chain("base", "finger") == whole
    assert arm.get_chain("base", "finger", links=False) == ["shoulder", "wrist", "grip"]
    assert arm.get_chain("base", "finger", links=False, fixed=False) == ["shoulder", "grip"]
    assert arm.get_chain("upper", "tool", joints=False) == ["upper", "tool"]
    with pytest.raises(KeyError):
        arm.get_chain("finger", "base")


def test_joint_has_limits_and_optional_elements(arm: Any) -> None:
    shoulder, wrist, grip = arm.joints
    assert (shoulder.type, shoulder.joint_type, shoulder.parent, shoulder.child) == (
        "revolute",
        "revolute",
        "base",
        "upper",
    )
    assert shoulder.axis == [0.0, 0.0, 1.0]
    assert (shoulder.origin.position, shoulder.origin.rotation) == ([0.0, 0.0, 0.3], [0.0, 0.0, 1.57])
    limit = shoulder.limit
    assert (limit.lower, limit.upper, limit.effort, limit.velocity) == (-1.5, 1.6, 10.0, 2.0)
    assert (shoulder.dynamics.damping, shoulder.dynamics.friction) == (0.1, None)
    assert (shoulder.safety_controller.k_position, shoulder.safety_controller.soft_upper_limit) == (4.0, 1.5)
    assert (shoulder.calibration.rising, shoulder.calibration.falling) == (0.1, 0)
    assert (wrist.axis, wrist.origin, wrist.limit, wrist.mimic) == (None, None, None, None)
    assert (grip.limit.lower, grip.limit.upper) == (0, 0)
    assert (grip.mimic.joint, grip.mimic.multiplier, grip.mimic.offset) == ("shoulder", -1.0, 0.5)


def test_a_link_has_shapes_and_inertia(arm: Any) -> None:
    base, upper, tool, finger = arm.links
    assert (base.inertial, base.visual, base.collision, base.visuals) == (None, None, None, [])
    assert (upper.inertial.mass, upper.inertial.origin.xyz, upper.inertial.origin.rpy) == (
        1.5,
        [0.0, 0.0, 0.1],
        None,
    )
    assert upper.inertial.inertia.to_matrix() == [[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]]
    assert upper.visual.geometry == Cylinder(0.05, 0.4)
    assert (upper.visual.material.name, upper.visual.origin.rpy) == ("grey", [0.0, 0.1, 0.0])
    assert upper.collision.geometry == Box([0.1, 0.2, 0.4])
    assert tool.visual.geometry == Mesh("package://arm/tool.stl", [0.001, 0.001, 0.001])
    assert finger.visual.geometry == Sphere(0.01)
    assert arm.materials[0].color.rgba == [0.5, 0.5, 0.5, 1.0]


def test_robot_can_be_read_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(f'<?xml version="1.0" encoding="utf-8"?>\n{ARM}', encoding="utf-8")
    assert URDF.from_xml_file(str(tmp_path / "arm.urdf")) == URDF.from_xml_string(ARM)
    built = Robot(name="two")
    with pytest.raises(AssertionError, match="No roots"):
        built.get_root()
    built.add_link(Link(name="a"))
    built.add_link(Link(name="b"))
    with pytest.raises(AssertionError, match="Multiple roots"):
        built.get_root()
    built.add_joint(Joint(name="j", parent="a", child="b", joint_type="fixed"))
    assert built.get_root() == "a"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot><link name='a'/></robot>", "Required attribute not set in XML: name"),
        ("<robot name='r'><link/></robot>", "Required attribute not set in XML: name"),
        ("<robot name='r'><joint name='j' type='odd'/></robot>", "Invalid joint type: odd"),
        (
            "<robot name='r'><joint name='j' type='fixed'/></robot>",
            "Required element not defined in XML: parent",
        ),
        (
            "<robot name='r'><link name='a'><visual><geometry><cone/></geometry></visual></link></robot>",
            "Unknown geometry: cone",
        ),
        (
            "<robot name='r'><link name='a'><inertial><mass value='heavy'/></inertial></link></robot>",
            "Attribute value is not a number: 'heavy'",
        ),
        ("<launch/>", "The root element is not a robot"),
    ],
)
def test_malformed_description_is_a_parse_error(text: str, message: str) -> None:
    with pytest.raises(ParseError, match=message):
        URDF.from_xml_string(text)


@bare
def test_a_node_reads_the_description_from_a_topic(start: Start) -> None:
    ros = start(
        """
        import rclpy
        from std_msgs.msg import Float64, String
        from urdf_parser_py.urdf import URDF
        from urdf_parser_py.xml_reflection.core import ParseError
        rclpy.init()
        node = rclpy.create_node("limits")
        pub = node.create_publisher(Float64, "upper", 1)
        def read(message):
            try:
                robot = URDF.from_xml_string(message.data)
            except ParseError:
                return
            pub.publish(Float64(data=robot.joint_map["shoulder"].limit.upper))
        node.create_subscription(String, "robot_description", read, 1)
        rclpy.spin(node)
        """
    )
    from pytest_tarl.ros import message_type

    messages = heard(ros, "/upper")
    text: Any = message_type("std_msgs/msg/String")
    ros.bus.publish("/robot_description", text(data="<robot/>"))
    ros.bus.publish("/robot_description", text(data=ARM))
    ros.step(0.1)
    assert [message.data for message in messages] == [1.6]


@bare
def test_a_node_reads_the_description_from_a_parameter(start: Start) -> None:
    ros = start(
        f"""
        import rospy
        from urdf_parser_py.urdf import Robot
        rospy.init_node("reader")
        rospy.set_param("/robot_description", {ARM!r})
        root = Robot.from_parameter_server().get_root()
        """
    )
    assert ros.namespace["root"] == "base"  # type: ignore[attr-defined]


@bare
def test_stand_in_modules_can_be_imported(start: Start) -> None:
    ros = start(
        """
        from urdf_parser_py import urdf
        from urdf_parser_py.xml_reflection import core
        from rosidl_runtime_py import convert, set_message, utilities
        found = urdf.URDF, core.ParseError, utilities.get_message, convert.message_to_yaml
        """
    )
    assert ros.namespace["found"][:2] == (URDF, ParseError)  # type: ignore[attr-defined]
