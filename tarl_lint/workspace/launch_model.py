"""The contents of a launch file: nodes, their names, remappings and parameters."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tarl_lint.workspace.model import Problem

Scalar = str | int | float | bool
Kind = Literal["node", "container", "component", "test"]  # "test": a program that rostest runs


@dataclass(frozen=True, slots=True)
class Setting:
    """One parameter, or several parameters as YAML.

    `name` is absolute or begins with `~`; for YAML, it is the namespace of the parameters.

    `file` contains the value: the launch file, or the YAML file that it loads. `unknown` says that only the robot
    knows the value: then `value` and `yaml` are None, or they are set under a condition known only on the robot.
    """

    name: str
    file: Path
    value: Scalar | None = None
    yaml: str | None = None
    unknown: bool = False


@dataclass(frozen=True, slots=True)
class LaunchedNode:
    """A node in a launch file. `settings` are its private parameters, in the order of setting.

    The first `inherited` remappings are those of the groups around the node. If the robot makes the name unique, as in
    `$(anon name)`, nodes with the same `name` and `anonymous` have the same name there; otherwise `anonymous` is "".
    `event` says that an event starts the node, possibly in place of another one.

    Names that only the robot knows stay symbolic: `/$(arg robot)`. `condition` is a condition that only the robot can
    evaluate; "" if the node is started in any case. For a component, `executable` is its class.
    """

    package: str
    executable: str
    name: str
    namespace: str
    file: Path
    line: int
    remaps: tuple[tuple[str, str], ...] = ()
    settings: tuple[Setting, ...] = ()
    arguments: str = ""
    kind: Kind = "node"
    condition: str = ""
    inherited: int = 0
    anonymous: str = ""
    event: bool = False


@dataclass(frozen=True, slots=True)
class Launch:
    """A launch file with its included files. `settings` are the parameters outside nodes.

    `arguments` are the names of its launch arguments, and `required` those without a value or default; `ros2` says
    whether it is for ROS 2.
    """

    file: Path
    nodes: tuple[LaunchedNode, ...] = ()
    settings: tuple[Setting, ...] = ()
    problems: tuple[Problem, ...] = ()
    arguments: tuple[str, ...] = ()
    ros2: bool = False
    required: tuple[str, ...] = ()
