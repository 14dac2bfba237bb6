"""rclpy.parameter_event_handler: callbacks for parameter changes of any node, from /parameter_events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.qos import qos_profile_parameter_events

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


@dataclass(eq=False)
class ParameterCallbackHandle:
    """A callback registered for one parameter of a node."""

    parameter_name: str
    node_name: str
    callback: Callable[[Any], None]


@dataclass(eq=False)
class ParameterEventCallbackHandle:
    """A callback registered for all events."""

    callback: Callable[[Any], None]


class ParameterEventHandler:
    """Calls callbacks when parameters change, newest callback first."""

    def __init__(self, node: Node, qos_profile: Any = qos_profile_parameter_events) -> None:
        self._node = node
        self._single: list[ParameterCallbackHandle] = []
        self._all: list[ParameterEventCallbackHandle] = []
        event = find_class("ros2", "rcl_interfaces", "ParameterEvent")
        self._subscription = node.create_subscription(event, "/parameter_events", self._take, qos_profile)

    def destroy(self) -> None:
        """Stop listening."""
        self._node.destroy_subscription(self._subscription)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[Any], None]
    ) -> ParameterCallbackHandle:
        """Call a function with the parameter (a message) whenever it changes."""
        handle = ParameterCallbackHandle(parameter_name, self._full(node_name), callback)
        self._single.insert(0, handle)
        return handle

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        """Remove a callback."""
        self._single.remove(handle)

    def add_parameter_event_callback(self, callback: Callable[[Any], None]) -> ParameterEventCallbackHandle:
        """Call a function with each event (a message)."""
        handle = ParameterEventCallbackHandle(callback)
        self._all.insert(0, handle)
        return handle

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        """Remove a callback."""
        self._all.remove(handle)

    @staticmethod
    def get_parameter_from_event(event: Any, parameter_name: str, node_name: str) -> Any:
        """Return a parameter from an event, or None if the event does not contain it."""
        if event.node != node_name:
            return None
        parameters = ParameterEventHandler.get_parameters_from_event(event)
        return next((one for one in parameters if one.name == parameter_name), None)

    @staticmethod
    def get_parameters_from_event(event: Any) -> list[Any]:
        """Return the new and changed parameters in an event."""
        return [*event.new_parameters, *event.changed_parameters]

    def _full(self, name: str) -> str:
        if not name:
            return str(self._node.get_fully_qualified_name())
        return name if name.startswith("/") else f"{self._node.get_namespace().rstrip('/')}/{name}"

    def _take(self, event: Any) -> None:
        for handle in [*self._single]:
            found = self.get_parameter_from_event(event, handle.parameter_name, handle.node_name)
            if found is not None:
                handle.callback(found)
        for listener in [*self._all]:
            listener.callback(event)
