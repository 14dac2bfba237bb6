"""Check the arguments of `tarl.external`: the command, its topics, services and limits."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError


@dataclass(frozen=True)
class Call:
    """A service of the simulator, with the fields of its request; the simulator determines the type."""

    service: str
    request: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Setup:
    """The checked arguments of `tarl.external` (see its documentation)."""

    command: tuple[str, ...]
    folder: Path
    environment: Mapping[str, str]
    clock: str
    ready: tuple[str, ...]
    step: Call | None
    reset: Call | None
    every_step: tuple[str, ...]
    timeout: float
    patience: float
    ros: str = "ros2"  # or "ros1"

    @property
    def shown(self) -> str:
        """Return the command as typed in a shell."""
        return shlex.join(self.command)


def setup(
    command: str | Sequence[str],
    folder: Path,
    *,
    environment: Mapping[str, str] | None,
    clock: str,
    ready: str | Sequence[str],
    step: str | Call | None,
    reset: str | Call | None,
    every_step: Sequence[str],
    timeout: float,
    patience: float,
) -> Setup:
    """Check the arguments and return them. Raise SettingsError."""
    parts = shlex.split(command) if isinstance(command, str) else [os.fspath(part) for part in command]
    topics = (ready,) if isinstance(ready, str) else tuple(ready)
    if not parts or not topics:
        raise SettingsError(
            "tarl.external needs a command and a topic that shows that the simulator is ready, such as "
            'tarl.external("ros2 launch my_robot simulation.launch.py", ready="/odom").'
        )
    return Setup(
        tuple(parts),
        folder,
        dict(environment or {}),
        clock,
        topics,
        Call(step) if isinstance(step, str) else step,
        Call(reset) if isinstance(reset, str) else reset,
        tuple(every_step),
        timeout,
        patience,
        _generation(),
    )


def _generation() -> str:
    """Return the installed ROS. Raise SettingsError if there is none."""
    for library, name in (("rclpy", "ros2"), ("rospy", "ros1")):
        if PathFinder.find_spec(library) is not None:
            return name
    raise SettingsError(
        "tarl.external talks to the simulator by rclpy or rospy, and neither is installed: source the setup.bash of "
        "your ROS, or pip install 'ros-rclpy[fastrtps]' for ROS 2."
    )
