"""The choice of the ROS on which a test runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.realros import choice
from pytest_tarl.ros import Ros


def node(folder: Path, text: str) -> Path:
    path = folder / "node.py"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("import rospy", ("rospy",)),
        ("from rospy.timer import sleep", ("rospy",)),
        ("import rclpy.node as node", ("rclpy",)),
        ("def late():\n    from rclpy.qos import QoSProfile", ("rclpy",)),
        ("import math", ()),
        ("from . import rospy", ()),
        ("import (", ()),
    ],
)
def test_client_library_is_the_imported_one(tmp_path: Path, text: str, found: tuple[str, ...]) -> None:
    assert choice.libraries([node(tmp_path, text)]) == found


def test_nodes_in_a_folder_are_found(tmp_path: Path) -> None:
    node(tmp_path, "import rclpy")
    assert choice.libraries([tmp_path]) == ("rclpy",)


def test_auto_falls_back_to_the_embedded_ros(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choice.PathFinder, "find_spec", lambda _: None)
    assert type(choice.make_ros("auto", [node(tmp_path, "import rospy")])) is Ros


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("import rospy", "rospy is not installed: apt-get install"),
        ("import rclpy", "rclpy is not installed: source"),
        ("import math", "no node of the marker imports rospy or rclpy"),
    ],
)
def test_the_error_names_the_missing_ros(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, says: str
) -> None:
    monkeypatch.setattr(choice.PathFinder, "find_spec", lambda _: None)
    with pytest.raises(SettingsError, match=says):
        choice.make_ros("real", [node(tmp_path, text)])


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(SettingsError, match="--tarl-ros does not know 'gazebo'"):
        choice.check_kind("gazebo")
