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

    `file` contains the value: the launch file, or the YAML file that it loads. `unknown` is True if the value is
    known only on the robot. Then `value` and `yaml` are None, or they hold a value that is set under a condition
    known only on the robot.
    """

    name: str
    file: Path
    value: Scalar | None = None
    yaml: str | None = None
    unknown: bool = False


@dataclass(frozen=True, slots=True)
class LaunchedNode:
    """A node in a launch file. `settings` are its private parameters, in the order of setting.

    The first `inherited` remappings are those of the groups around the node. If the name is made unique on the
    robot, as in `$(anon name)`, `anonymous` is not empty: two nodes have the same name on the robot if both their
    `name` and their `anonymous` are equal. Otherwise `anonymous` is "". `event` is True if an event starts the
    node, possibly in place of another node.

    Names that are known only on the robot stay symbolic: `/$(arg robot)`. `condition` is a condition that can be
    evaluated only on the robot; "" if the node is always started. For a component, `executable` is its class.
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

    `arguments` are the names of its launch arguments, and `required` are the names of arguments without a value or
    default. `ros2` is True for a launch file of ROS 2.
    """

    file: Path
    nodes: tuple[LaunchedNode, ...] = ()
    settings: tuple[Setting, ...] = ()
    problems: tuple[Problem, ...] = ()
    arguments: tuple[str, ...] = ()
    ros2: bool = False
    required: tuple[str, ...] = ()
