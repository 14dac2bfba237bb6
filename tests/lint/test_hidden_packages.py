"""Packages that a marker hides are read, with a note, only if a launch file names them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tarl_lint.settings.config import Options, resolve
from tarl_lint.system.command import ALL, Request, systems
from tarl_lint.system.model import System

from .test_system import MANIFEST, RELAY, write

NODE = '<node pkg="arm" type="relay.py" name="arm"/>'
NODE2 = "Node(package='arm', executable='relay.py', name='arm')"
PYTHON = """\
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare
from launch.substitutions import PathJoinSubstitution
from ament_index_python.packages import get_package_share_directory
def generate_launch_description():
    return LaunchDescription([{}])
"""
WAYS = {
    "a.launch": f"<launch>{NODE}</launch>",
    "b.launch": '<launch><include file="$(find arm)/launch/arm.launch"/></launch>',
    "c.launch.py": PYTHON.format(NODE2),
    "d.launch.py": PYTHON.format(
        "IncludeLaunchDescription(PathJoinSubstitution([FindPackageShare('arm'), 'launch', 'own.launch.py']))"
    ),
    "e.launch.py": PYTHON.format(
        "IncludeLaunchDescription(get_package_share_directory('arm') + '/launch/own.launch.py')"
    ),
    "f.launch.yaml": "launch:\n- node: {pkg: arm, exec: relay.py, name: arm}\n",
    "g.launch.xml": '<launch><node pkg="arm" exec="relay.py" name="arm"/></launch>',
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a workspace in which `arms/CATKIN_IGNORE` hides one node, and `legs/COLCON_IGNORE` hides another node."""
    hidden = {
        f"{one}s/{one}/{name}": text
        for one in ("arm", "leg")
        for name, text in {
            "package.xml": MANIFEST.format(one, "catkin"),
            "scripts/relay.py": RELAY,
            f"launch/{one}.launch": f"<launch>{NODE.replace('arm', one)}</launch>",
            "launch/own.launch.py": PYTHON.format(NODE2.replace("arm", one)),
        }.items()
    }
    files = {
        "arms/CATKIN_IGNORE": "",
        "legs/COLCON_IGNORE": "",
        "robot/package.xml": MANIFEST.format("robot", "catkin"),
    }
    return write(
        tmp_path, {**hidden, **files, **{f"robot/launch/{name}": text for name, text in WAYS.items()}}
    )


def launched(folder: Path, launch: str) -> tuple[System, ...]:
    return systems(Request(launch, paths=(folder,)), resolve(Options()))


def flows(system: System) -> list[tuple[str, str, str]]:
    return [(hop.node, hop.source, hop.sink) for hop in system.hops]


@pytest.mark.parametrize("name", WAYS)
def test_hidden_package_is_read_if_a_launch_file_names_it(name: str, folder: Path) -> None:
    (system,) = launched(folder, str(folder / "robot/launch" / name))
    assert flows(system) == [("/arm", "/in", "/out")]
    (problem,) = system.problems
    assert problem.file == folder / "arms/CATKIN_IGNORE"
    assert problem.reason.startswith("the file hides the package arm from ROS, but the launch file needs it")


@pytest.mark.parametrize("named", ["arm.launch", "arm/arm.launch", "arms/arm/launch/arm.launch"])
def test_launch_file_of_a_hidden_package_can_be_named(
    named: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    (system,) = launched(folder, named)
    assert flows(system) == [("/arm", "/in", "/out")]
    assert [one.file.name for one in system.problems] == ["CATKIN_IGNORE"]


def test_all_launch_files_option_skips_hidden_packages(folder: Path) -> None:
    found = launched(folder, ALL)
    assert sorted(one.file.name for one in found) == sorted(WAYS)
    assert not any("legs" in str(problem.file) for one in found for problem in one.problems)


def test_without_hidden_packages_the_report_has_no_note(folder: Path) -> None:
    (folder / "arms/CATKIN_IGNORE").unlink()
    (system,) = launched(folder, str(folder / "robot/launch/a.launch"))
    assert (flows(system), system.problems) == ([("/arm", "/in", "/out")], ())
