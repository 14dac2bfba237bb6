"""The environment variables that a sourced ROS sets, for nodes that read them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from pytest_tarl.ros.messages.type_definitions import Kind

_OF_KIND: Mapping[Kind, Mapping[str, str]] = {
    "ros1": {
        "ROS_VERSION": "1",
        "ROS_DISTRO": "noetic",
        "ROS_PYTHON_VERSION": "3",
        "ROS_MASTER_URI": "http://localhost:11311",
    },
    "ros2": {"ROS_VERSION": "2", "ROS_DISTRO": "humble", "ROS_PYTHON_VERSION": "3"},
}


@contextmanager
def variables_restored() -> Iterator[None]:
    """Undo all calls of `set_variables` on exit."""
    names = {name for variables in _OF_KIND.values() for name in variables}
    before = {name: os.environ.get(name) for name in sorted(names)}
    try:
        yield
    finally:
        for name, value in before.items():
            if value is not None:
                os.environ[name] = value
            else:
                os.environ.pop(name, None)


def set_variables(kind: Kind) -> None:
    """Set the variables of a ROS generation that are not set yet."""
    for name, value in _OF_KIND[kind].items():
        os.environ.setdefault(name, value)
