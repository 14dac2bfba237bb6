"""Helpers that read launch files of a package `arm`."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.read import read

HEAD = """
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch_ros.substitutions import FindPackageShare
def node(name="drive", **given):
    return Node(package="arm", executable="drive", name=name, **given)
"""


def launched(package: Path, text: str, name: str = "a.launch", **arguments: str) -> Launch:
    (package / name).write_text(dedent(text), encoding="utf-8")
    return read_launch(package / name, read(package.parent), arguments)


def described(package: Path, body: str, **arguments: str) -> Launch:
    """Read a launch file whose description has the actions of this body, in lines."""
    text = f"{HEAD}\ndef generate_launch_description():\n    return LaunchDescription([\n{body}\n    ])\n"
    return launched(package, text, "a.launch.py", **arguments)


def reasons(found: Launch) -> list[str]:
    return [one.reason for one in found.problems]


def names(found: Launch) -> list[str]:
    return [f"{one.namespace.rstrip('/')}/{one.name}" for one in found.nodes]


def settings(node: LaunchedNode) -> dict[str, object]:
    return {
        one.name: "unknown" if one.unknown else one.yaml if one.value is None else one.value
        for one in node.settings
    }
