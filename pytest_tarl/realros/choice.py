"""Select the ROS of an episode: the embedded one, or the installed one if the nodes import it."""

from __future__ import annotations

import ast
import atexit
from collections.abc import Iterable
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Literal

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros import Ros

KINDS = ("embedded", "real", "auto")
Library = Literal["rospy", "rclpy"]
_INSTALL = {
    "rospy": "rospy is not installed: apt-get install python3-rospy python3-rosmaster (Debian, Ubuntu), or "
    "source the setup.bash of your ROS",
    "rclpy": "rclpy is not installed: source the setup.bash of your ROS, or pip install 'ros-rclpy[fastrtps]'",
}


def make_ros(kind: str, nodes: Iterable[Path]) -> Ros:
    """Return the ROS of an episode. Raise SettingsError if an installed ROS is required but missing."""
    if kind == "embedded":
        return Ros()
    wanted = libraries(nodes)
    library: Library | None = next((one for one in wanted if PathFinder.find_spec(one) is not None), None)
    if library is None and kind == "auto":
        return Ros()
    if library is None:
        reason = _INSTALL[wanted[0]] if wanted else "no node of the marker imports rospy or rclpy"
        raise SettingsError(f"--tarl-ros=real: {reason}.")
    return _rospy() if library == "rospy" else _rclpy()


def check_kind(kind: str) -> str:
    """Return the value of --tarl-ros. Raise SettingsError if it is unknown."""
    if kind not in KINDS:
        raise SettingsError(
            f"--tarl-ros does not know {kind!r}; it takes {', '.join(KINDS[:-1])} or {KINDS[-1]}."
        )
    return kind


def libraries(nodes: Iterable[Path]) -> tuple[Library, ...]:
    """Return the client libraries that the files import, in order of appearance."""
    found: dict[Library, None] = {}
    for node in nodes:
        for file in sorted(node.rglob("*.py")) if node.is_dir() else [node]:
            found.update(dict.fromkeys(_imported(file)))
    return tuple(found)


def _imported(file: Path) -> list[Library]:
    try:
        tree = ast.parse(file.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return []  # Python will report the error when the file runs
    found: list[Library] = []
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names = [node.module]
        for name in names:
            root = name.partition(".")[0]
            if root == "rospy":
                found.append("rospy")
            elif root == "rclpy":
                found.append("rclpy")
    return found


def _rospy() -> Ros:
    from pytest_tarl.realros.rospy_ros import RospyRos, close_network

    atexit.register(close_network)
    return RospyRos()


def _rclpy() -> Ros:
    from pytest_tarl.realros.rclpy_ros import RclpyRos, close_network

    atexit.register(close_network)
    return RclpyRos()
