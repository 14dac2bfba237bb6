"""The six parameter services of a node, created when one of them is first requested."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.callback_groups import ReentrantCallbackGroup
from pytest_tarl.ros.rclpy.exceptions import ParameterException
from pytest_tarl.ros.rclpy.parameter import Parameter, ParameterType
from pytest_tarl.ros.rclpy.parameters import outcome
from pytest_tarl.ros.rclpy.services import Service

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node

_NAMES = {
    "GetParameters": "get_parameters",
    "GetParameterTypes": "get_parameter_types",
    "SetParameters": "set_parameters",
    "SetParametersAtomically": "set_parameters_atomically",
    "ListParameters": "list_parameters",
    "DescribeParameters": "describe_parameters",
}


def offer_parameter_services(node: Node) -> None:
    """Offer `/node/set_parameters` and the five other services."""
    names = {kind: f"{node.get_fully_qualified_name()}/{name}" for kind, name in _NAMES.items()}
    directory = node.process.ros.services

    def make() -> None:
        directory.withdraw(names.values())
        group = ReentrantCallbackGroup()
        handlers = ParameterServices(node)
        for kind, name in names.items():
            made: Any = find_class("ros2", "rcl_interfaces", kind, "srv")
            node.services_.append(Service(node, made, name, getattr(handlers, _NAMES[kind]), group))

    directory.offer(names.values(), make)


class ParameterServices:
    """Handles requests for a node's parameters."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def get_parameters(self, request: Any, response: Any) -> Any:
        """Return values, or an empty list if any parameter is not declared."""
        try:
            response.values = [
                p.get_parameter_value() for p in self._node.get_parameters(list(request.names))
            ]
        except ParameterException:
            response.values = []
        return response

    def get_parameter_types(self, request: Any, response: Any) -> Any:
        """Return types, or an empty list if any parameter is not declared."""
        try:
            response.types = [int(t) for t in self._node.get_parameter_types(list(request.names))]
        except ParameterException:
            response.types = []
        return response

    def set_parameters(self, request: Any, response: Any) -> Any:
        """Set parameters one by one."""
        response.results = [self._set([message]) for message in request.parameters]
        return response

    def set_parameters_atomically(self, request: Any, response: Any) -> Any:
        """Set all parameters or none."""
        response.result = self._set(request.parameters)
        return response

    def list_parameters(self, request: Any, response: Any) -> Any:
        """Return names."""
        response.result = self._node.list_parameters(list(request.prefixes), request.depth)
        return response

    def describe_parameters(self, request: Any, response: Any) -> Any:
        """Return descriptors, or an empty list if any parameter is not declared."""
        try:
            response.descriptors = self._node.describe_parameters(list(request.names))
        except ParameterException:
            response.descriptors = []
        return response

    def _set(self, messages: list[Any]) -> Any:
        parameters = [Parameter.from_parameter_msg(message) for message in messages]
        try:
            return self._node.set_parameters_atomically(parameters)
        except ParameterException as error:
            return outcome(False, str(error))


def parameter_event(node: Node, parameters: list[Parameter], known: set[str]) -> Any:
    """Create rcl_interfaces/ParameterEvent for changed parameters; `known` are those declared before."""
    made: Any = find_class("ros2", "rcl_interfaces", "ParameterEvent")
    event = made(stamp=node.get_clock().now().to_msg(), node=node.get_fully_qualified_name())
    for parameter in parameters:
        message = parameter.to_parameter_msg()
        if parameter.type_ == ParameterType.NOT_SET:
            event.deleted_parameters.append(message)
        elif parameter.name in known:
            event.changed_parameters.append(message)
        else:
            event.new_parameters.append(message)
    return event
