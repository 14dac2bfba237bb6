"""The parameter server of an episode and rospy's functions for it."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.process import current_process

if TYPE_CHECKING:
    from pytest_tarl.ros.episode import Ros
    from pytest_tarl.ros.rospy.node import RospyNode

_NOTHING = object()


class ParameterServer:
    """The tree of parameters that all rospy nodes of an episode share."""

    def __init__(self, ros: Ros) -> None:
        self._root: dict[str, Any] = {}
        self._private: dict[str, Any] = {}  # given by the test for every node
        for name, value in ros.parameters.items():
            if not name.startswith("~"):
                self.set(absolute(name), value)
            if not name.startswith("/"):
                self._private[name.removeprefix("~")] = value

    def enter_node(self, node: str) -> None:
        """Give a new node the parameters that the test set without naming a node."""
        for name, value in self._private.items():
            if self.get(f"{node}/{name}") is None:
                self.set(f"{node}/{name}", value)

    def get(self, name: str, default: Any = None) -> Any:
        """Return the value, or the subtree as a dict."""
        branch: Any = self._root
        for key in _keys(name):
            if not isinstance(branch, dict) or key not in branch:
                return default
            branch = branch[key]
        return deepcopy(branch)

    def set(self, name: str, value: Any) -> None:
        """Set a value; a dict becomes a subtree."""
        keys = _keys(name)
        if not keys:
            self._root = deepcopy(value)
            return
        branch = self._root
        for key in keys[:-1]:
            if not isinstance(branch.get(key), dict):
                branch[key] = {}
            branch = branch[key]
        branch[keys[-1]] = deepcopy(value)

    def delete(self, name: str) -> bool:
        """Remove a parameter or a subtree; tell whether it was there."""
        *path, last = _keys(name)
        branch: Any = self._root
        for key in path:
            branch = branch.get(key) if isinstance(branch, dict) else None
        return isinstance(branch, dict) and branch.pop(last, _NOTHING) is not _NOTHING

    def names(self) -> list[str]:
        """List all parameters."""
        return list(_leaves("", self._root))


def _keys(name: str) -> list[str]:
    return [key for key in name.split("/") if key]


def _leaves(prefix: str, branch: dict[str, Any]) -> list[str]:
    found = []
    for key, value in branch.items():
        found += _leaves(f"{prefix}/{key}", value) if isinstance(value, dict) else [f"{prefix}/{key}"]
    return found


def _server(api: str) -> tuple[RospyNode, ParameterServer]:
    from pytest_tarl.ros.rospy.node import RospyNode

    process = current_process(f"rospy.{api}")
    return process.part(RospyNode), process.ros.part(ParameterServer)


def get_param(param_name: str, default: Any = _NOTHING) -> Any:
    """Return a parameter. Raises KeyError if it is not set and there is no default."""
    node, server = _server("get_param")
    value = server.get(node.resolve(param_name), _NOTHING)
    if value is not _NOTHING:
        return value
    if default is _NOTHING:
        raise KeyError(param_name)
    return default


get_param_cached = get_param


def set_param(param_name: str, param_value: Any) -> None:
    """Set a parameter."""
    node, server = _server("set_param")
    server.set(node.resolve(param_name), param_value)


def has_param(param_name: str) -> bool:
    """Tell whether a parameter is set."""
    node, server = _server("has_param")
    return server.get(node.resolve(param_name), _NOTHING) is not _NOTHING


def delete_param(param_name: str) -> None:
    """Remove a parameter. Raises KeyError if it is not set."""
    node, server = _server("delete_param")
    if not server.delete(node.resolve(param_name)):
        raise KeyError(param_name)


def search_param(param_name: str) -> str | None:
    """Return the full name of the nearest parameter of that name, from the node's own namespace upwards."""
    node, server = _server("search_param")
    path = _keys(node.name)
    for length in range(len(path), -1, -1):
        name = absolute("/".join([*path[:length], param_name]))
        if server.get(name, _NOTHING) is not _NOTHING:
            return name
    return None


def get_param_names() -> list[str]:
    """List all parameters."""
    return _server("get_param_names")[1].names()
