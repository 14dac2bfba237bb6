"""Find the message packages of an installed ROS in this environment, and their generation."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from pytest_tarl.ros.messages.type_definitions import Kind

_asked: list[Kind] = []  # ROS generations of the look-ups in progress, innermost last


@cache
def installed_kind(package: str) -> Kind | None:
    """Return the ROS generation of the installed Python package, or None if it is not installed.

    No import is needed, as file names differ: genpy writes `msg/_Twist.py`, rosidl `msg/_twist.py`.
    """
    spec = PathFinder.find_spec(package)
    if spec is None or spec.submodule_search_locations is None:
        return None
    for root in spec.submodule_search_locations:
        for part in ("msg", "srv"):
            for file in sorted(Path(root, part).glob("_[A-Za-z]*.py")):
                return "ros1" if file.stem[1].isupper() else "ros2"
    return None


def installed_class(kind: Kind, package: str, name: str, part: str) -> type[Any] | None:
    """Return the class from an installed ROS of this generation, or None."""
    if installed_kind(package) != kind:
        return None
    _asked.append(kind)
    try:
        found: type[Any] | None = getattr(import_module(f"{package}.{part}"), name, None)
    finally:
        _asked.pop()
    return found


def asked_kind() -> Kind | None:
    """Return the generation of the class being looked up, or None if the import has another origin."""
    return _asked[-1] if _asked else None
