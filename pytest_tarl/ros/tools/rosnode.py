"""rosnode: which nodes are there."""

# ruff: noqa: ARG001 (signatures are rosnode's)

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.missing import refuse
from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.tools import graph

__all__ = ["ROSNodeException", "ROSNodeIOException", "get_node_names", "kill_nodes", "rosnode_ping"]


class ROSNodeException(Exception):  # noqa: N818 (these names are rosnode's)
    """A node could not be asked."""


class ROSNodeIOException(ROSNodeException):
    """The master could not be asked."""


def get_node_names(namespace: str | None = None) -> list[str]:
    """List the nodes, of one namespace where that is given."""
    return sorted(name for name in graph.nodes() if graph.below(name, namespace))


def rosnode_ping(
    node_name: str, max_count: int | None = None, verbose: bool = False, skip_cache: bool = False
) -> bool:
    """Tell whether a node is there."""
    return absolute(node_name) in graph.nodes()


def kill_nodes(node_names: list[str]) -> tuple[list[str], list[str]]:
    """Ask nodes to end; return those that were there and those that were not."""
    there = graph.nodes()
    killed = [name for name in node_names if absolute(name) in there]
    for name in killed:
        there[absolute(name)].ask_to_end()
    return killed, [name for name in node_names if name not in killed]


def __getattr__(name: str) -> Any:
    """Name what is missing."""
    raise refuse("rosnode", name)
