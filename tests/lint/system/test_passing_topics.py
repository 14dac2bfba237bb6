"""Programs that pass on what they receive: image_transport, topic_tools, and C++ programs that publish images."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.lint.test_system import MANIFEST, flows, launched, relay, run, workspace, write

__all__ = ["workspace"]


def ends(capsys: pytest.CaptureFixture[str], file: str, number: int = 0) -> tuple[list[str], list[str]]:
    """Return the topics of a node by launched name."""
    _, out, _ = run(capsys, "--launch", file, "--format", "json")
    node: dict[str, Any] = json.loads(out)["systems"][0]["nodes"][number]
    subscribed, published = ([one["name"] for one in node[role]] for role in ("subscribes", "publishes"))
    return subscribed, published


@pytest.mark.parametrize(
    ("arguments", "inside", "subscribed", "published"),
    [
        ("compressed raw in:=/cam/image out:=/cam/plain", "", ["/cam/image/compressed"], ["/cam/plain"]),
        ("raw in:=/cam/image out:=/small", "", ["/cam/image"], ["/small", "/small/compressed"]),
        ("raw compressed", '<remap from="in" to="image"/>', ["/image"], ["/out/compressed"]),
        (
            "compressed raw",
            '<remap from="in/compressed" to="/other/compressed"/><remap from="out" to="/plain"/>',
            ["/other/compressed"],
            ["/plain"],
        ),
        (
            "",
            '<param name="in_transport" value="compressed"/>',
            ["/in/compressed"],
            ["/out", "/out/compressed"],
        ),
    ],
)
def test_republish_converts_the_transports_of_an_image(
    workspace, capsys, arguments, inside, subscribed, published
):
    node = f'<node pkg="image_transport" type="republish" name="r" args="{arguments}">{inside}</node>'
    assert ends(capsys, launched(workspace, node)) == (subscribed, published)


@pytest.mark.parametrize(
    ("arguments", "subscribed"),
    [
        ("load image_transport/republish manager compressed raw", ["/in/compressed"]),
        ("standalone image_transport/republish raw raw", ["/in"]),
        ("load image_view/disparity manager", []),
    ],
)
def test_republish_may_be_a_nodelet(workspace, capsys, arguments, subscribed):
    node = f'<node pkg="nodelet" type="nodelet" name="r" args="{arguments}"/>'
    assert ends(capsys, launched(workspace, node))[0] == subscribed


def test_ros2_republish_takes_transports_first(workspace, capsys):
    node = """<node pkg="image_transport" exec="republish" name="r" args="compressed raw">
    <remap from="in/compressed" to="/cam/compressed"/><remap from="out" to="/plain"/></node>"""
    assert ends(capsys, launched(workspace, node, "a.launch.xml")) == (["/cam/compressed"], ["/plain"])


def test_a_chain_passes_through_republish(workspace, capsys):
    republish = (
        '<node pkg="image_transport" type="republish" name="r" args="compressed raw in:=/cam out:=/plain"/>'
    )
    file = launched(
        workspace, relay("camera", "/light", "/cam/compressed") + republish + relay("eye", "/plain", "/go")
    )
    _, out, _ = run(capsys, "--launch", file)
    assert flows(out) == [
        "/light → /camera → /cam/compressed → [/r, not read] → /plain → /eye → /go  not read"
    ]


@pytest.mark.parametrize(
    ("program", "arguments", "subscribed", "published"),
    [
        ("relay", "/scan /other", ["/scan"], ["/other"]),
        ("relay", "/scan", ["/scan"], ["/scan_relay"]),
        ("throttle", "messages /scan 5.0", ["/scan"], ["/scan_throttle"]),
        ("throttle", "messages /scan 5.0 slow", ["/scan"], ["/slow"]),
        ("throttle", "bytes /scan 9000 1.0 slow", ["/scan"], ["/slow"]),
        ("drop", "/scan 1 2", ["/scan"], ["/scan_drop"]),
        ("mux", "/cmd_vel /joy_vel /nav_vel", ["/joy_vel", "/nav_vel"], ["/cmd_vel"]),
        ("demux", "/in /a /b", ["/in"], ["/a", "/b"]),
        ("transform", "/in /out std_msgs/Float64 m --import std_msgs", ["/in"], ["/out"]),
        ("transform", "/in /out std_msgs/Float64", [], []),
        ("relay_field", "/in/header /out std_msgs/Header m.header", ["/in/header"], ["/out"]),
        ("throttle", "messages", [], []),
        ("relay", "", [], []),
        ("relay", "$(env IN) /out", [], ["/out"]),
    ],
)
def test_programs_of_topic_tools_name_their_topics_in_arguments(
    workspace, capsys, program, arguments, subscribed, published
):
    node = f'<node pkg="topic_tools" type="{program}" name="t" args="{arguments}"/>'
    assert ends(capsys, launched(workspace, node)) == (subscribed, published)


@pytest.mark.parametrize(
    ("program", "parameters", "subscribed", "published"),
    [
        ("relay", {"input_topic": "/scan"}, ["/scan"], ["/scan_relay"]),
        ("throttle", {"input_topic": "/scan", "output_topic": "/slow"}, ["/scan"], ["/slow"]),
        ("mux", {"input_topics": "[/a, /b]"}, ["/a", "/b"], ["/t/selected"]),
        ("demux", {"output_topics": "[/a, /b]"}, ["/t/input"], ["/a", "/b"]),
        ("delay", {"input_topic": "$(env TOPIC)"}, [], []),
    ],
)
def test_topic_tools_name_their_topics_in_ros2_parameters(
    workspace, capsys, program, parameters, subscribed, published
):
    inside = "".join(f'<param name="{name}" value="{value}"/>' for name, value in parameters.items())
    node = f'<node pkg="topic_tools" exec="{program}" name="t">{inside}</node>'
    component = f"""<node_container pkg="rclcpp_components" exec="component_container" name="c">
        <composable_node pkg="topic_tools" plugin="topic_tools::{program.title()}Node" name="t">{inside}
        </composable_node></node_container>"""
    assert ends(capsys, launched(workspace, node, "a.launch.xml")) == (subscribed, published)
    assert ends(capsys, launched(workspace, component, "b.launch.xml"), 1) == (subscribed, published)


def test_ros2_republish_does_not_rename_out_compressed(workspace, capsys):
    node = """<node pkg="image_transport" exec="republish" name="r">
        <param name="in_transport" value="raw"/><param name="out_transport" value="compressed"/>
        <remap from="in" to="/cam"/><remap from="out" to="/small"/></node>"""
    exact = node.replace('from="out"', 'from="out/compressed"')
    component = f"""<node_container pkg="rclcpp_components" exec="component_container" name="c">
        {
        exact.replace(
            'node pkg="image_transport" exec="republish"',
            'composable_node pkg="image_transport" plugin="image_transport::Republisher"',
        ).replace("</node>", "</composable_node>")
    }</node_container>"""
    assert ends(capsys, launched(workspace, node, "a.launch.xml")) == (["/cam"], ["/out/compressed"])
    assert ends(capsys, launched(workspace, exact, "b.launch.xml")) == (["/cam"], ["/small"])
    assert ends(capsys, launched(workspace, component, "c.launch.xml"), 1) == (["/cam"], ["/small"])


SELECTING = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
from topic_tools.srv import MuxSelect
def on_mode(msg):
    choose(msg.data)
rospy.init_node("chooser")
choose = rospy.ServiceProxy("{service}", MuxSelect)
rospy.Subscriber("/mode", String, on_mode)
rospy.spin()
"""


@pytest.mark.parametrize(
    ("service", "inside"),
    [
        ("/mux/select", ""),
        ("/cmd_vel_select", ""),
        ("/drive/select", '<remap from="mux" to="drive"/>'),
    ],
)
def test_multiplexer_request_chooses_the_topic(workspace, capsys, service, inside):
    write(workspace, {"arm/scripts/chooser.py": SELECTING.format(service=service)})
    file = launched(
        workspace,
        f'<node pkg="topic_tools" type="mux" name="drive" args="/cmd_vel /joy_vel /nav_vel">{inside}</node>'
        '<node pkg="arm" type="chooser.py" name="chooser"/>',
    )
    _, out, _ = run(capsys, "--launch", file, "--from", "/mode")
    assert flows(out)[0].startswith(f"/mode → /chooser → {service} (request) → [/drive, not read] → /cmd_vel")


@pytest.mark.parametrize(
    ("node", "subscribed", "published"),
    [
        (
            '<node pkg="nodelet" type="nodelet" name="d" args="load image_proc/debayer manager"/>',
            ["/image_raw"],
            ["/image_mono", "/image_mono/compressed", "/image_color", "/image_color/compressed"],
        ),
        (
            (
                '<node pkg="nodelet" type="nodelet" name="v" args="load pcl/VoxelGrid manager">'
                '<remap from="~input" to="/points"/></node>'
            ),
            ["/points"],
            ["/v/output"],
        ),
        (
            (
                '<node pkg="nodelet" type="nodelet" name="l"'
                ' args="standalone depthimage_to_laserscan/DepthImageToLaserScanNodelet">'
                '<remap from="image" to="/depth/image_raw"/></node>'
            ),
            ["/depth/image_raw", "/depth/camera_info"],
            ["/scan"],
        ),
        (
            '<node pkg="pointcloud_to_laserscan" type="pointcloud_to_laserscan_node" name="p"/>',
            ["/cloud_in"],
            ["/scan"],
        ),
        (
            (
                '<node pkg="nodelet" type="nodelet" name="v" args="load pcl/VoxelGrid manager">'
                '<remap from="~extra" to="/points"/></node>'
            ),
            [],
            [],
        ),
        ('<node pkg="nodelet" type="nodelet" name="m" args="manager"/>', [], []),
    ],
)
def test_topics_of_installed_programs_and_nodelets_are_known(workspace, capsys, node, subscribed, published):
    found = ends(capsys, launched(workspace, node))
    assert [sorted(one) for one in found] == [sorted(subscribed), sorted(published)]


CAMERA = """
#include <image_transport/image_transport.h>
int main() {
  ros::NodeHandle nh;
  image_transport::ImageTransport it(nh);
  image_transport::Publisher pub = it.advertise("image", 1);
  auto camera = it.advertiseCamera("left/image", 1);
  auto sub = it.subscribe("mask", 1, on_mask);
  ros::Publisher plain = nh.advertise<sensor_msgs::Image>("plain", 1);
}
"""


def camera(workspace, inside: str) -> str:
    write(
        workspace,
        {
            "eye/package.xml": MANIFEST.format("eye", "catkin"),
            "eye/CMakeLists.txt": "add_executable(camera src/camera.cpp)\n",
            "eye/src/camera.cpp": CAMERA,
        },
    )
    return launched(workspace, f'<node pkg="eye" type="camera" name="camera">{inside}</node>')


def test_a_cpp_program_publishes_images_in_several_transports(workspace, capsys):
    assert ends(capsys, camera(workspace, '<remap from="image" to="/front/image"/>')) == (
        ["/mask"],
        ["/front/image", "/front/image/compressed", "/left/image", "/left/image/compressed", "/left/camera_info",
         "/plain"],
    )  # fmt: skip


def test_cpp_program_uses_the_image_transport_of_its_parameter(workspace, capsys):
    parameter = '<param name="image_transport" value="compressed"/>'
    assert ends(capsys, camera(workspace, parameter))[0] == ["/mask/compressed"]


def test_ros2_functions_with_a_node_create_image_endpoints(workspace, capsys):
    file = camera(workspace, "")
    source = workspace / "eye/src/camera.cpp"
    source.write_text('auto pub = image_transport::create_publisher(this, "image");\n'
                      'auto sub = image_transport::create_subscription(this, "in", on, "raw");\n')  # fmt: skip
    assert ends(capsys, file) == (["/in"], ["/image", "/image/compressed"])
