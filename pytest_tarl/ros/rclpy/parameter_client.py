"""rclpy's client for another node's parameters."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.missing import unsupported
from pytest_tarl.ros.rclpy.parameter import Parameter
from pytest_tarl.ros.rclpy.services import Client
from pytest_tarl.ros.rclpy.task import Future

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node

__all__ = ["AsyncParameterClient"]

Done = Callable[[Future], Any]


class AsyncParameterClient:
    """Reads and sets another node's parameters through its six parameter services."""

    def __init__(
        self, node: Node, remote_node_name: str, qos_profile: Any = None, callback_group: Any = None
    ) -> None:
        self.node = node
        self.remote_node_name = remote_node_name
        self._clients = {
            name: _client(node, name, f"{remote_node_name}/{service}", callback_group)
            for name, service in _SERVICES.items()
        }

    def services_are_ready(self) -> bool:
        """Return whether the node's parameter services are available."""
        return all(client.service_is_ready() for client in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait for each of the node's parameter services, up to the timeout; return whether all are available."""
        return all(client.wait_for_service(timeout_sec) for client in self._clients.values())

    def list_parameters(
        self, prefixes: Sequence[str] | None = None, depth: int | None = None, callback: Done | None = None
    ) -> Future:
        """Request names; the future's result is a ListParameters response."""
        return self._ask("ListParameters", callback, prefixes=list(prefixes or ()), depth=depth or 0)

    def get_parameters(self, names: Iterable[str], callback: Done | None = None) -> Future:
        """Request values."""
        return self._ask("GetParameters", callback, names=list(names))

    def get_parameter_types(self, names: Iterable[str], callback: Done | None = None) -> Future:
        """Request types."""
        return self._ask("GetParameterTypes", callback, names=list(names))

    def describe_parameters(self, names: Iterable[str], callback: Done | None = None) -> Future:
        """Request descriptors."""
        return self._ask("DescribeParameters", callback, names=list(names))

    def set_parameters(self, parameters: Iterable[Any], callback: Done | None = None) -> Future:
        """Set parameters, given as `Parameter` objects or messages, one by one."""
        return self._ask("SetParameters", callback, parameters=[_message(one) for one in parameters])

    def set_parameters_atomically(self, parameters: Iterable[Any], callback: Done | None = None) -> Future:
        """Set all parameters or none."""
        return self._ask(
            "SetParametersAtomically", callback, parameters=[_message(one) for one in parameters]
        )

    def delete_parameters(self, names: Iterable[str], callback: Done | None = None) -> Future:
        """Delete parameters that the node declared without a fixed type."""
        return self.set_parameters([Parameter(name, Parameter.Type.NOT_SET) for name in names], callback)

    def on_parameter_event(self, callback: Any, qos_profile: Any = 10, **options: Any) -> Any:
        """Call `callback(event)` whenever parameters of any node change."""
        event = find_class("ros2", "rcl_interfaces", "ParameterEvent")
        return self.node.create_subscription(event, "/parameter_events", callback, qos_profile, **options)

    def load_parameter_file(self, *_: Any, **__: Any) -> Future:
        """Raise UnsupportedApiError: parameter files are not supported here."""
        raise unsupported("AsyncParameterClient.load_parameter_file")

    load_parameter_file_atomically = load_parameter_file

    def _ask(self, kind: str, callback: Done | None, **fields: Any) -> Future:
        client = self._clients[kind]
        future = client.call_async(client.srv_type.Request(**fields))
        if callback is not None:
            future.add_done_callback(callback)
        return future


_SERVICES = {
    "GetParameters": "get_parameters",
    "ListParameters": "list_parameters",
    "SetParameters": "set_parameters",
    "GetParameterTypes": "get_parameter_types",
    "DescribeParameters": "describe_parameters",
    "SetParametersAtomically": "set_parameters_atomically",
}


def _client(node: Node, kind: str, name: str, group: Any) -> Client:
    return node.create_client(find_class("ros2", "rcl_interfaces", kind, "srv"), name, callback_group=group)


def _message(parameter: Any) -> Any:
    return parameter.to_parameter_msg() if isinstance(parameter, Parameter) else parameter
