"""The parameter server of an episode."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from pytest_tarl.ros.names import absolute

_ABSENT = object()


class ParameterServer:
    """The tree of parameters shared by all rospy nodes of an episode."""

    def __init__(self, given: Mapping[str, Any]) -> None:
        self._root: dict[str, Any] = {}
        self._private: dict[str, Any] = {}  # the test's private parameters, for every node
        self.take(given)

    def take(self, given: Mapping[str, Any]) -> None:
        """Set the test's parameters."""
        for name, value in given.items():
            if not name.startswith("~"):
                self.set(absolute(name), value)
            if not name.startswith("/"):
                self._private[name.removeprefix("~")] = value

    def enter_node(self, node: str) -> None:
        """Copy the test's private parameters to a new node."""
        for name, value in self._private.items():
            if self.get(f"{node}/{name}") is None:
                self.set(f"{node}/{name}", value)

    def get(self, name: str, default: Any = None) -> Any:
        """Return a value, or a subtree as a dictionary."""
        branch: Any = self._root
        for key in keys_of(name):
            if not isinstance(branch, dict) or key not in branch:
                return default
            branch = branch[key]
        return deepcopy(branch)

    def set(self, name: str, value: Any) -> None:
        """Set a value; a dict becomes a subtree."""
        keys = keys_of(name)
        if not keys:
            self._root = deepcopy(value)
            return
        branch = self._root
        for key in keys[:-1]:
            if not isinstance(branch.get(key), dict):
                branch[key] = {}
            branch = branch[key]
        branch[keys[-1]] = deepcopy(value)

    def fill(self, name: str, value: Any) -> None:
        """Set a value, or the leaves of a subtree, unless they are already set."""
        if isinstance(value, dict) and value:
            for key, inner in value.items():
                self.fill(f"{name}/{key}", inner)
        elif self.get(name, _ABSENT) is _ABSENT:
            self.set(name, value)

    def delete(self, name: str) -> bool:
        """Remove a parameter or a subtree; return whether it existed."""
        *path, last = keys_of(name)
        branch: Any = self._root
        for key in path:
            branch = branch.get(key) if isinstance(branch, dict) else None
        return isinstance(branch, dict) and branch.pop(last, _ABSENT) is not _ABSENT

    def names(self) -> list[str]:
        """Return the names of all parameters."""
        return list(_leaves("", self._root))


def keys_of(name: str) -> list[str]:
    """Split a parameter's name at slashes."""
    return [key for key in name.split("/") if key]


def _leaves(prefix: str, branch: dict[str, Any]) -> list[str]:
    found = []
    for key, value in branch.items():
        found += _leaves(f"{prefix}/{key}", value) if isinstance(value, dict) else [f"{prefix}/{key}"]
    return found
