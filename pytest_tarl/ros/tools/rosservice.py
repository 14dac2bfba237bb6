"""rosservice: list and call services."""

from __future__ import annotations

from typing import Any

from pytest_tarl.ros.rospy.services import ServiceProxy
from pytest_tarl.ros.tools import graph

__all__ = [
    "ROSServiceException", "ROSServiceIOException", "call_service", "get_service_class_by_name", "get_service_list",
    "get_service_node", "get_service_type",
]  # fmt: skip


class ROSServiceException(Exception):  # noqa: N818 (these names are rosservice's)
    """A query about a service failed."""


class ROSServiceIOException(ROSServiceException):
    """The master could not be reached."""


def get_service_list(node: str | None = None, namespace: str | None = None) -> list[str]:
    """Return the names of all services, or of those of a node or in a namespace."""
    entries = [(name, nodes) for name, nodes in graph.ends()[2] if graph.below(name, namespace)]
    return sorted(name for name, nodes in entries if node is None or graph.resolved(node) in nodes)


def get_service_type(service_name: str) -> str | None:
    """Return the type of a service, or None if it is unknown."""
    found = graph.services().get(graph.resolved(service_name))
    return None if found is None else str(found._type)


def get_service_class_by_name(service_name: str) -> Any:
    """Return a service's class. Raise ROSServiceException if the service is unknown."""
    found = graph.services().get(graph.resolved(service_name))
    if found is None:
        raise ROSServiceException(f"Service [{service_name}] is not available.")
    return found


def get_service_node(service_name: str) -> str | None:
    """Return the node that offers a service."""
    return next((nodes[0] for name, nodes in graph.ends()[2] if name == graph.resolved(service_name)), None)


def call_service(service_name: str, service_args: Any, service_class: Any = None) -> tuple[Any, Any]:
    """Call a service with a list of values or a dictionary of fields; return request and response."""
    made = service_class or get_service_class_by_name(service_name)
    if isinstance(service_args, list) and len(service_args) == 1 and isinstance(service_args[0], dict):
        service_args = service_args[0]
    given = isinstance(service_args, dict)
    request = made._request_class(**service_args) if given else made._request_class(*service_args)
    return request, ServiceProxy(service_name, made).call(request)
