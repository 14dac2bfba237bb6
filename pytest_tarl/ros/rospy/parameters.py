"""rospy's parameter functions."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.parameter_server import ParameterServer, keys_of
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.rospy.node import RospyNode, warn_if_illegal

_NOTHING = object()


def _server(api: str) -> tuple[RospyNode, ParameterServer]:
    process = current_process(f"rospy.{api}")
    return process.part(RospyNode), process.ros.parameter_server


def get_param(param_name: str, default: Any = _NOTHING) -> Any:
    """Return a parameter. Raise KeyError if it is not set and has no default."""
    asked()
    node, server = _server("get_param")
    name = node.resolve(param_name)
    value = server.get(name, _NOTHING)
    if value is not _NOTHING:
        node.process.ros.read(name, value)
        return value
    if default is _NOTHING:
        raise KeyError(param_name)
    if default is None:
        node.process.unset[param_name] = None
    return default


get_param_cached = get_param


def set_param(param_name: str, param_value: Any) -> None:
    """Set a parameter."""
    warn_if_illegal(param_name, stacklevel=3)
    node, server = _server("set_param")
    server.set(node.resolve(param_name), param_value)


def has_param(param_name: str) -> bool:
    """Return whether a parameter is set."""
    asked()
    node, server = _server("has_param")
    found = server.get(node.resolve(param_name), _NOTHING) is not _NOTHING
    if not found:
        node.process.unset[param_name] = None
    return found


def delete_param(param_name: str) -> None:
    """Remove a parameter. Raise KeyError if it is not set."""
    node, server = _server("delete_param")
    if not server.delete(node.resolve(param_name)):
        raise KeyError(param_name)


def search_param(param_name: str) -> str | None:
    """Return the full name of the nearest parameter of this name, from the node's namespace upwards."""
    asked()
    node, server = _server("search_param")
    path = keys_of(node.name)
    for length in range(len(path), -1, -1):
        name = absolute("/".join([*path[:length], param_name]))
        if server.get(name, _NOTHING) is not _NOTHING:
            return name
    return None


def get_param_names() -> list[str]:
    """Return the names of all parameters."""
    return _server("get_param_names")[1].names()
