from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.ros.command_line_values import parse_value
from pytest_tarl.ros.names import absolute, parse_ros1, parse_ros2, resolve


@pytest.mark.parametrize(
    ("name", "resolved"),
    [
        ("odom", "/robot/odom"),
        ("/odom", "/odom"),
        ("~odom", "/robot/node/odom"),
        ("a//b/", "/robot/a/b"),
        ("~/x", "/robot/node/x"),
    ],
)
def test_names_are_relative_global_or_private(name: str, resolved: str) -> None:
    assert resolve(name, "/robot/node", {}) == resolved


@pytest.mark.parametrize("old", ["odom", "/robot/odom"])
@pytest.mark.parametrize("new", ["pose", "/robot/pose"])
def test_a_remapping_applies_to_the_resolved_name(old: str, new: str) -> None:
    assert resolve("odom", "/robot/node", {old: new}) == "/robot/pose"
    assert resolve("/robot/odom", "/robot/node", {old: new}) == "/robot/pose"
    assert resolve("other", "/robot/node", {old: new}) == "/robot/other"


def test_absolute_names_have_single_slashes() -> None:
    assert [absolute(name) for name in ("odom", "/odom/", "//a//b", "/")] == ["/odom", "/odom", "/a/b", "/"]


def test_the_ros1_command_line_is_parsed() -> None:
    line = parse_ros1(
        ["file.bag", "a:=b", "_gain:=2.5", "__name:=n", "__ns:=/r", "_on:=true", "_list:=[1, 2]"]
    )
    assert line.remappings == {"a": "b"}
    assert line.parameters == {"~gain": 2.5, "~on": True, "~list": [1, 2]}
    assert (line.name, line.namespace, line.rest) == ("n", "/r", ("file.bag",))


def test_the_ros2_command_line_is_parsed() -> None:
    line = parse_ros2(["x", "--ros-args", "-r", "a:=b", "-p", "gain:=2", "-r", "__node:=n", "--", "y", "-r"])
    assert (line.remappings, line.parameters, line.name) == ({"a": "b"}, {"gain": 2}, "n")
    assert line.rest == ("x", "y", "-r")


@pytest.mark.parametrize(
    ("text", "value"),
    [("1", 1), ("1.5", 1.5), ("-3e2", -300.0), ("True", True), ("off", False), ("'1'", "1"), ("base_link", "base_link"),
     ("[a, 2]", ["a", 2]), ("", "")],
)  # fmt: skip
def test_values_are_parsed_as_on_a_command_line(text: str, value: object) -> None:
    assert parse_value(text) == value
    assert type(parse_value(text)) is type(value)


def test_parameter_files_named_on_the_command_line_are_read(tmp_path: Path) -> None:
    file = tmp_path / "params.yaml"
    file.write_text("/**:\n  ros__parameters:\n    gain: 2.5\n")
    line = parse_ros2(["--ros-args", "-p", "low:=1", "--params-file", str(file)])
    assert line.parameters == {"low": 1, "/**": {"ros__parameters": {"gain": 2.5}}}
    with pytest.raises(RuntimeError, match=r"Couldn't parse params file.*Error opening"):
        parse_ros2(["--ros-args", "--params-file", str(tmp_path / "none.yaml")])
