"""Launch configurations that a ROS 2 launch file saves, restores and forgets, and values that depend on them."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_parameters import stated
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.name_resolution import joined
from tarl_lint.workspace.python.evaluator import constant
from tarl_lint.workspace.python.operators import BITS
from tarl_lint.workspace.python.values import Unknown
from tarl_lint.workspace.read import read

HEAD = """
from typing import List
from launch import LaunchDescription
from launch.actions import *
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushRosNamespace, SetParameter, SetRemap
from launch_ros.parameter_descriptions import Parameter, ParameterFile
def cam(name, **given):
    return Node(package="cam", executable="cam", name=name, **given)
"""


def launched(tmp_path: Path, text: str, name: str) -> Launch:
    base = tmp_path / "rig"
    (base / "config").mkdir(parents=True)
    (base / "package.xml").write_text("<package><name>rig</name></package>")
    (base / "config/cam.yaml").write_text("/**:\n  ros__parameters: {frame: $(var side)_cam, rate: 5}\n")
    path = base / name
    path.write_text((HEAD if name.endswith(".py") else "") + dedent(text))
    return read_launch(path, read(tmp_path), {})


def values(node: LaunchedNode) -> dict[str, Any]:
    return {one.name: one.value for one in stated(node.settings, joined(node.namespace, node.name))}


def test_saved_launch_configurations_are_restored(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        def generate_launch_description():
            side = LaunchConfiguration("side", default="gone")
            return LaunchDescription([
                SetLaunchConfiguration("side", "left"),
                PushLaunchConfigurations(),
                SetLaunchConfiguration("side", "right"),
                PushRosNamespace("inner"),
                SetRemap("image", "picture"),
                cam(["a_", side]),
                PopLaunchConfigurations(),
                cam(["b_", side]),
                UnsetLaunchConfiguration("side"),
                cam(["c_", side]),
            ])
        """, "x.launch.py")  # fmt: skip

    assert [(joined(one.namespace, one.name), one.remaps) for one in found.nodes] == [
        ("/inner/a_right", (("image", "picture"),)),
        ("/b_left", ()),
        ("/c_gone", ()),
    ]


def test_unforwarded_group_knows_only_its_own_configurations(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        def generate_launch_description():
            side, kind = (LaunchConfiguration(one, default="gone") for one in ("side", "kind"))
            return LaunchDescription([
                SetLaunchConfiguration("side", "left"),
                SetLaunchConfiguration("kind", "mono"),
                PushRosNamespace("outer"),
                SetParameter("rate", 5),
                GroupAction([cam([side, "_", kind])], forwarding=False, launch_configurations={"kind": side}),
                cam([side, "_", kind]),
                ResetLaunchConfigurations({"kind": "stereo"}),
                cam([side, "_", kind]),
            ])
        """, "x.launch.py")  # fmt: skip

    assert [(joined(one.namespace, one.name), values(one)) for one in found.nodes] == [
        ("/gone_left", {}),
        ("/outer/left_mono", {"~rate": 5}),
        ("/gone_stereo", {}),
    ]


def test_xml_groups_keep_launch_configurations(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        <launch>
          <let name="side" value="left"/>
          <group forwarding="false">
            <keep name="kept" value="$(var side)"/>
            <node pkg="cam" exec="cam" name="$(var side none)_$(var kept)"/>
          </group>
          <node pkg="cam" exec="cam" name="$(var side)_$(var kept none)"/>
          <reset><keep name="kept" value="2"/></reset>
          <node pkg="cam" exec="cam" name="$(var side none)_$(var kept)"/>
        </launch>
        """, "x.launch.xml")  # fmt: skip

    assert [one.name for one in found.nodes] == ["none_left", "left_none", "none_2"]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("x.launch.py", """
            def generate_launch_description():
                path = "/".join(__file__.split("/")[:-1]) + "/config/cam.yaml"
                return LaunchDescription([
                    SetLaunchConfiguration("side", "left"),
                    cam("one", parameters=[ParameterFile(path, allow_substs=True)]),
                    cam("two", parameters=[ParameterFile(path)]),
                ])
            """),
        ("x.launch.xml", """
            <launch>
              <let name="side" value="left"/>
              <node pkg="cam" exec="cam" name="one">
                <param from="$(dirname)/config/cam.yaml" allow_substs="true"/>
              </node>
              <node pkg="cam" exec="cam" name="two"><param from="$(dirname)/config/cam.yaml"/></node>
            </launch>
            """),
        ("x.launch.yaml", """
            launch:
            - let: {name: side, value: left}
            - node:
                pkg: cam
                exec: cam
                name: one
                param: [{from: $(dirname)/config/cam.yaml, allow_substs: true}]
            - node: {pkg: cam, exec: cam, name: two, param: [{from: $(dirname)/config/cam.yaml}]}
            """),
    ],
)  # fmt: skip
def test_substitutions_in_a_parameter_file_need_permission(tmp_path: Path, name: str, text: str) -> None:
    one, two = launched(tmp_path, text, name).nodes

    assert values(one) == {"~frame": "left_cam", "~rate": 5}
    assert values(two)["~rate"] == 5
    assert values(two)["~frame"] != "left_cam"


def test_a_set_of_remappings_and_single_parameters_are_read(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        def generate_launch_description():
            topic = LaunchConfiguration("topic", default="cmd_vel")
            return LaunchDescription([
                cam("one", remappings={("/cmd_vel", topic), ("odom", "wheels")},
                    parameters=[Parameter("safe", "True", value_type=str), Parameter(name="gain", value=2.5)]),
            ])
        """, "x.launch.py")  # fmt: skip

    (node,) = found.nodes
    assert node.remaps == (("/cmd_vel", "cmd_vel"), ("odom", "wheels"))
    assert values(node) == {"~safe": "True", "~gain": 2.5}


def test_environment_variables_that_the_launch_file_sets_are_known(tmp_path: Path) -> None:
    found = launched(tmp_path, """
        from launch.substitutions import EnvironmentVariable
        def generate_launch_description():
            side = EnvironmentVariable("SIDE", default_value="none")
            return LaunchDescription([
                cam(["a_", side]),
                GroupAction([SetEnvironmentVariable("SIDE", "left"), cam(["b_", side])]),
                cam(["c_", side]),
                SetEnvironmentVariable("SIDE", "right"),
                cam(["d_", side]),
                UnsetEnvironmentVariable("SIDE"),
                cam(["e_", side]),
            ])
        """, "x.launch.py")  # fmt: skip
    assert [one.name for one in found.nodes] == ["a_none", "b_left", "c_none", "d_right", "e_none"]
    text = """<launch><set_env name="SIDE" value="up"/><node pkg="cam" exec="cam" name="$(env SIDE none)"/>
        <unset_env name="SIDE"/><node pkg="cam" exec="cam" name="$(env SIDE none)"/></launch>"""
    found = launched(tmp_path / "xml", text, "x.launch.xml")
    assert [one.name for one in found.nodes] == ["up", "none"]


@pytest.mark.parametrize(
    ("value", "read"),
    [
        ('["only"]', ["only"]),
        ('["1", "b"]', ["1", "b"]),
        ("[1, 2.5]", [1.0, 2.5]),
        ("(True, False)", [True, False]),
        ('["a", LaunchConfiguration("n", default="5")]', "a5"),
        ('[[LaunchConfiguration("n", default="5")], ["6"]]', [5, 6]),
        ('[["a", LaunchConfiguration("n", default=", b")], "c"]', ["a, b", "c"]),
    ],
)
def test_lists_have_the_types_that_launch_gives_them(tmp_path: Path, value: str, read: object) -> None:
    found = launched(tmp_path, f"""
        def generate_launch_description():
            return LaunchDescription([cam("a", parameters=[{{"given": {value}}}])])
        """, "x.launch.py")  # fmt: skip
    assert repr(values(found.nodes[0])["~given"]) == repr(read)


@pytest.mark.parametrize(
    ("text", "value"),
    [("2 ** 10", 1024), ("9 ** 0.5", 3.0), ("2 ** -1", 0.5), ("(3.0 ** 2 + 4 ** 2) ** 0.5", 5.0)],
)
def test_powers_are_evaluated(text: str, value: float) -> None:
    assert constant(text) == value


@pytest.mark.parametrize("text", [f"2 ** {BITS}", "9 ** 9 ** 9", "(-8) ** 0.5", "1e300 ** 9", "0 ** -1"])
def test_too_large_or_complex_powers_are_unknown(text: str) -> None:
    assert isinstance(constant(text), Unknown)
