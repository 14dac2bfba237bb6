"""The ROS graph as seen by a master; the simulated world is not a node in it."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.parameter_server import ParameterServer
from pytest_tarl.ros.process import Process, current_process
from pytest_tarl.ros.rospy.node import RospyNode, this_node
from pytest_tarl.ros.services import ServiceDirectory

Entry = tuple[str, list[str]]  # (topic or service, its nodes)


def resolved(name: str) -> str:
    """Resolve a name in the running node's namespace."""
    return this_node("resolve_name").resolve(name)


def nodes() -> dict[str, Process]:
    """Return the running rospy nodes by name."""
    processes = [one for one in current_process("rosgraph").ros.processes if not one.ended]
    found = [(one.part(RospyNode), one) for one in processes]
    return {node.name: process for node, process in found if node.initialised}


def ends() -> tuple[list[Entry], list[Entry], list[Entry]]:
    """Return the publishers, subscribers and services, each with the names of the nodes."""
    process = current_process("rosgraph")
    publishers: list[Entry] = []
    subscribers: list[Entry] = []
    for place in process.bus.topics():
        for wanted, given in ((publishers, place.publications), (subscribers, place.subscriptions)):
            labels = sorted({end.process.label for end in given})
            if labels:
                wanted.append((place.name, labels))
    return publishers, subscribers, [(name, [label]) for name, label in _servers()]


def topic_types() -> dict[str, str]:
    """Return the types of the topics that nodes publish on or subscribe to, by topic name."""
    found = {}
    for place in current_process("rosgraph").bus.topics():
        kinds = [publication.type for publication in place.publications]
        kinds += [_type(end.message_type) for end in place.subscriptions]
        named = [kind for kind in kinds if kind != "*"]
        if kinds:
            found[place.name] = (named or kinds)[0]
    return found


def services() -> dict[str, Any]:
    """Return the service classes, by name."""
    return dict(directory().names())


def directory() -> ServiceDirectory:
    """Return the service directory."""
    return current_process("rosservice").ros.services


def parameters() -> ParameterServer:
    """Return the parameter server."""
    return current_process("rosparam").ros.parameter_server


def below(name: str, namespace: str | None) -> bool:
    """Return whether a name is in a namespace; an empty namespace contains all names."""
    inside = "/" + (namespace or "").strip("/")
    return inside == "/" or name == inside or name.startswith(inside + "/")


def _servers() -> list[tuple[str, str]]:
    made = directory()
    found = []
    for name, _ in made.names():
        endpoint = made.find(name)
        process = getattr(endpoint, "process", None) or getattr(
            getattr(endpoint, "node", None), "process", None
        )
        found.append((name, process.label if isinstance(process, Process) else "/world"))
    return found


def _type(message_type: Any) -> str:
    return str(getattr(message_type, "_type", "*"))
