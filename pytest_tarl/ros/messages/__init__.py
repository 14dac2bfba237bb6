"""ROS message and service classes: those of an installed ROS, or built from definitions."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, cast

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros.messages import node_workspaces, ros1, ros2
from pytest_tarl.ros.messages.installed_packages import installed_class
from pytest_tarl.ros.messages.known import Part
from pytest_tarl.ros.messages.type_definitions import Kind, has_known_types

_BUILDERS: dict[tuple[Kind, Part], Callable[[str, str], type[Any] | None]] = {
    ("ros1", "msg"): ros1.message_class,
    ("ros1", "srv"): ros1.service_class,
    ("ros2", "msg"): ros2.message_class,
    ("ros2", "srv"): ros2.service_class,
    ("ros2", "action"): ros2.action_class,
}


def message_type(name: str) -> type[Any]:
    """Return a message class by its ROS name.

    `nav_msgs/Odometry` is the ROS 1 class, and `nav_msgs/msg/Odometry` the ROS 2 class. Nodes can receive messages of
    either class: a subscriber always gets an instance of the class that it subscribed with. Names of services and
    actions have the same forms: `std_srvs/SetBool` (ROS 1), `std_srvs/srv/SetBool` and
    `nav2_msgs/action/NavigateToPose` (ROS 2). Definitions in the caller's repository are found even before any node is
    started.

    Raise UnsupportedApiError if the type is unknown.
    """
    package, *middle, short = name.split("/") if "/" in name else ("", name)
    if middle not in ([], ["msg"], ["srv"], ["action"]) or not package or not short:
        raise UnsupportedApiError(f"{name!r} is not the name of a message type: write 'nav_msgs/msg/Odometry' "
                                  "(ROS 2) or 'nav_msgs/Odometry' (ROS 1).")  # fmt: skip
    _search_around(package, sys._getframe(1).f_globals.get("__file__"))
    if middle:
        found = find_class("ros2", package, short, cast("Part", middle[0]))
    else:
        found = find_class("ros1", package, short) or find_class("ros1", package, short, "srv")
    if found is None:
        raise unknown_type(package, short)
    return found


def _search_around(package: str, file: str | None) -> None:
    """Search the repository of `file` (or its folder) first, unless TARL itself knows the package."""
    root = None if not file or has_known_types(package) else _root_around(file)
    if root is not None:
        node_workspaces.prefer(root)


@cache
def _root_around(file: str) -> Path | None:
    return node_workspaces.root_around(Path(file).parent, Path(file).parent)


node_workspaces.on_forget(_root_around.cache_clear)


@node_workspaces.by_order
def find_class(kind: Kind, package: str, name: str, part: Part = "msg") -> type[Any] | None:
    """Return the class of a message (`part` msg), service (srv) or action type, or None if it is unknown."""
    builder = _BUILDERS.get((kind, part))
    return installed_class(kind, package, name, part) or (
        builder(package, name) if builder is not None else None
    )


def class_of(kind: Kind, name: str) -> type[Any]:
    """Return the message class of a type, `package/Name`. Raise UnsupportedApiError if it is unknown."""
    package, _, short = name.partition("/")
    found = find_class(kind, package, short)
    if found is None:
        raise unknown_type(package, short)
    return found


def unknown_type(package: str, name: str) -> UnsupportedApiError:
    """Return the error for a type without a definition."""
    return UnsupportedApiError(
        f"Message type {package}/{name} is unknown: neither `rosbags` nor TARL has its definition, "
        f"there is no {name}.msg, .srv or .action in the node's repository, and no installed ROS package "
        f"{package!r} of the right generation was found. Check the spelling, or put the package's definitions "
        "below the repository, or install it (source your workspace) in the environment that runs pytest."
    )
