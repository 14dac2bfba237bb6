"""rosgraph: queries to the master."""

# ruff: noqa: ARG001, N802 (the signatures are the master's)

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pytest_tarl.ros import names
from pytest_tarl.ros.missing import refuse
from pytest_tarl.ros.rospy import node
from pytest_tarl.ros.tools import graph

__all__ = ["Master", "MasterError", "MasterException", "is_master_online"]

URI = "http://localhost:11311/"
_NOTHING = object()


class MasterException(Exception):  # noqa: N818 (these names are rosgraph's)
    """The master could not be reached."""


class MasterError(MasterException):
    """The master refused a request."""


MasterFailure = MasterError
Error = MasterError


class Master:
    """Answers queries about the episode."""

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.caller_id = caller_id
        self.master_uri = master_uri or URI

    def is_online(self) -> bool:
        """Return True."""
        return True

    def getUri(self) -> str:
        """Return a dummy address: there is no network."""
        return self.master_uri

    def getPid(self) -> int:
        """Return a dummy process id."""
        return 1

    def getSystemState(self) -> list[list[list[Any]]]:
        """Return publishers, subscribers and services, each as [name, [nodes]]."""
        return [[[name, labels] for name, labels in entries] for entries in graph.ends()]

    def getPublishedTopics(self, subgraph: str = "") -> list[list[str]]:
        """Return published topics with their types."""
        types = graph.topic_types()
        published = [name for name, _ in graph.ends()[0] if graph.below(name, subgraph)]
        return [[name, types[name]] for name in published]

    def getTopicTypes(self) -> list[list[str]]:
        """Return all topics with their types."""
        return [[name, kind] for name, kind in graph.topic_types().items()]

    def lookupNode(self, node_name: str) -> str:
        """Return a node's address. Raise MasterError for an unknown node."""
        if names.absolute(node_name) not in graph.nodes():
            raise MasterError(f"unknown node [{node_name}]")
        return "http://localhost:0/"

    def lookupService(self, service: str) -> str:
        """Return a service's address. Raise MasterError if no node offers it."""
        if self._full(service) not in graph.directory():
            raise MasterError("no provider")
        return "rosrpc://localhost:0"

    def hasParam(self, key: str) -> bool:
        """Return whether a parameter is set."""
        return graph.parameters().get(self._full(key), _NOTHING) is not _NOTHING

    def getParam(self, key: str) -> Any:
        """Return a parameter. Raise MasterError if it is not set."""
        value = graph.parameters().get(self._full(key), _NOTHING)
        if value is _NOTHING:
            raise MasterError(f"Parameter [{self._full(key)}] is not set")
        return value

    def setParam(self, key: str, value: Any) -> None:
        """Set a parameter."""
        graph.parameters().set(self._full(key), value)

    def deleteParam(self, key: str) -> None:
        """Remove a parameter. Raise MasterError if it is not set."""
        if not graph.parameters().delete(self._full(key)):
            raise MasterError(f"parameter [{self._full(key)}] is not set")

    def searchParam(self, key: str) -> str | None:
        """Return the full name of the nearest parameter of this name, from the caller's namespace upwards."""
        path = [part for part in self.caller_id.split("/") if part]
        tried = (names.absolute("/".join([*path[:length], key])) for length in range(len(path), -1, -1))
        return next((name for name in tried if self.hasParam(name)), None)

    def getParamNames(self) -> list[str]:
        """List all parameters."""
        return graph.parameters().names()

    def _full(self, name: str) -> str:
        return names.expand(name, names.absolute(self.caller_id))

    def __getattr__(self, name: str) -> Any:
        raise refuse("rosgraph.Master", name)


class MasterProxy:
    """What `rospy.get_master()` returns: answers queries with (code, status, value)."""

    target = Master("/rospy")

    def __getattr__(self, name: str) -> Any:
        asked = getattr(self.target, name)

        def ask(*arguments: Any) -> tuple[int, str, Any]:
            try:
                return 1, name, asked(*arguments)
            except MasterError as error:
                return -1, str(error), 0

        return ask


def is_master_online(master_uri: str | None = None) -> bool:
    """Return True."""
    return True


def get_master_uri() -> str:
    """Return a dummy address: there is no network."""
    return URI


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """Return the command line without ROS arguments."""
    return node.myargv(argv)
