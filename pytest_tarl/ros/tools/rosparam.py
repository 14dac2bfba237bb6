"""rosparam: parameter files, and functions to get, set and delete parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pytest_tarl.ros.command_line_values import parse_value
from pytest_tarl.ros.missing import unsupported
from pytest_tarl.ros.names import absolute, expand
from pytest_tarl.ros.rospy.node import this_node
from pytest_tarl.ros.tools import graph

__all__ = [
    "RosParamException", "RosParamIOException", "delete_param", "get_param", "list_params", "load_file", "load_str",
    "set_param", "upload_params",
]  # fmt: skip

_NOTHING = object()
Loaded = list[tuple[dict[str, Any], str]]


class RosParamException(Exception):  # noqa: N818 (these names are rosparam's)
    """A parameter or a parameter file cannot be used."""


class RosParamIOException(RosParamException):
    """The master could not be reached."""


def load_file(filename: str, default_namespace: str | None = None, verbose: bool = False) -> Loaded:
    """Read a YAML file of parameters. Raise RosParamException if it cannot be read."""
    path = Path(filename)
    if not path.is_file():
        raise RosParamException(f"file [{filename}] does not exist")
    return load_str(path.read_text(encoding="utf-8"), filename, default_namespace, verbose)


def load_str(text: str, filename: str, default_namespace: str | None = None, verbose: bool = False) -> Loaded:
    """Parse parameters from YAML; return (parameters, namespace) for each document.

    Raise RosParamException for invalid YAML.
    """
    try:
        import yaml
    except ModuleNotFoundError:
        raise unsupported("Reading YAML for rosparam without PyYAML (pip install PyYAML)") from None
    try:
        documents = [one for one in yaml.safe_load_all(text) if one]
    except yaml.YAMLError as error:
        raise RosParamException(f"Invalid YAML in file [{filename}]: {error}") from error
    loaded = []
    for document in documents:
        namespace = document.pop("_ns", None) or default_namespace or "/"
        if verbose:
            print(f"reading parameters into namespace [{namespace}]")
        loaded.append((document, expand(namespace, this_node("rosparam").name)))
    return loaded


def upload_params(ns: str, values: Any, verbose: bool = False) -> None:
    """Set a dictionary of parameters below a namespace. Raise RosParamException for other values in `/`."""
    if absolute(ns) == "/" and not isinstance(values, dict):
        raise RosParamException("global / can only be set to a dictionary")
    if verbose:
        print(f"set parameter [{ns}] to [{values}]")
    for name, value in values.items() if isinstance(values, dict) else [("", values)]:
        graph.parameters().set(f"{graph.resolved(ns)}/{name}", value)


def get_param(param_name: str) -> Any:
    """Return a parameter. Raise RosParamException if it is not set."""
    value = graph.parameters().get(graph.resolved(param_name), _NOTHING)
    if value is _NOTHING:
        raise RosParamException(f"Parameter [{param_name}] is not set")
    return value


def set_param(param: str, value: str, verbose: bool = False) -> None:
    """Set a parameter to a value given as YAML text."""
    upload_params(param, parse_value(value), verbose)


def delete_param(param: str, verbose: bool = False) -> None:
    """Remove a parameter. Raise RosParamException if it is not set."""
    if not graph.parameters().delete(graph.resolved(param)):
        raise RosParamException(f"Parameter [{param}] is not set")
    if verbose:
        print(f"deleted parameter [{param}]")


def list_params(ns: str) -> list[str]:
    """List the parameters of a namespace."""
    return sorted(name for name in graph.parameters().names() if graph.below(name, graph.resolved(ns)))
