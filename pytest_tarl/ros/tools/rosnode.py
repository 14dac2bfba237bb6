"""rosnode: list, ping and end nodes."""

# ruff: noqa: ARG001 (signatures are rosnode's)

from __future__ import annotations

from pytest_tarl.ros.names import absolute
from pytest_tarl.ros.tools import graph

__all__ = ["ROSNodeException", "ROSNodeIOException", "get_node_names", "kill_nodes", "rosnode_ping"]


class ROSNodeException(Exception):  # noqa: N818 (these names are rosnode's)
    """A node could not be reached."""


class ROSNodeIOException(ROSNodeException):
    """The master could not be reached."""


def get_node_names(namespace: str | None = None) -> list[str]:
    """Return the names of all nodes, or of those in a namespace."""
    return sorted(name for name in graph.nodes() if graph.below(name, namespace))


def rosnode_ping(
    node_name: str, max_count: int | None = None, verbose: bool = False, skip_cache: bool = False
) -> bool:
    """Return whether a node is running."""
    return absolute(node_name) in graph.nodes()


def kill_nodes(node_names: list[str]) -> tuple[list[str], list[str]]:
    """Ask nodes to end; return the names of those that were running and of those that were not."""
    there = graph.nodes()
    killed = [name for name in node_names if absolute(name) in there]
    for name in killed:
        there[absolute(name)].ask_to_end()
    return killed, [name for name in node_names if name not in killed]
