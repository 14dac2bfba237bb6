"""rclpy's LifecycleNode."""

from __future__ import annotations

from typing import Any

from pytest_tarl.errors import text_of
from pytest_tarl.ros.messages import find_class
from pytest_tarl.ros.rclpy.exceptions import RCLError
from pytest_tarl.ros.rclpy.lifecycle.entities import LifecyclePublisher, ManagedEntity
from pytest_tarl.ros.rclpy.lifecycle.states import (
    CALLBACKS,
    ERROR_PROCESSING,
    FINALIZED,
    LABELS,
    TRANSITIONS,
    UNCONFIGURED,
    LifecycleState,
    Transition,
    TransitionCallbackReturn,
    state,
)
from pytest_tarl.ros.rclpy.node import Node

_SUCCESS, _FAILURE, _ERROR = TransitionCallbackReturn
_SERVICES = {
    "ChangeState": "change_state",
    "GetState": "get_state",
    "GetAvailableStates": "get_available_states",
    "GetAvailableTransitions": "get_available_transitions",
}


class LifecycleNodeMixin(ManagedEntity):
    """Mixin of LifecycleNode: states and transitions. By default, callbacks call those of the managed entities."""

    def __init__(self, *, enable_communication_interface: bool = True, **_: Any) -> None:
        self._state = UNCONFIGURED
        self._managed_entities: list[ManagedEntity] = []
        self._announce: Any = None
        if enable_communication_interface:
            self._serve()

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Trigger the transition, which calls `on_configure`."""
        return self._change(1)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Trigger the transition, which calls `on_cleanup`."""
        return self._change(2)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Trigger the transition, which calls `on_activate`."""
        return self._change(3)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Trigger the transition, which calls `on_deactivate`."""
        return self._change(4)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Trigger the transition, which calls `on_shutdown`. Raise RCLError if the state does not allow it."""
        for transition in TRANSITIONS:
            if transition.label == "shutdown" and transition.start == self._state:
                return self._change(transition.number)
        raise RCLError("Shutdown transtion not possible")  # rclpy's own spelling

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Add an entity that takes part in all transitions. Raise TypeError if it is not a ManagedEntity."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._managed_entities.append(entity)

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        """Create a publisher that publishes only while the node is active."""
        publisher: LifecyclePublisher = self.create_publisher(  # type: ignore[attr-defined]
            *args, publisher_class=LifecyclePublisher, **kwargs
        )
        self.add_managed_entity(publisher)
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Destroy a lifecycle publisher."""
        if publisher in self._managed_entities:
            self._managed_entities.remove(publisher)
        destroyed: bool = self.destroy_publisher(publisher)  # type: ignore[attr-defined]
        return destroyed

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run this callback of every managed entity; return the first result that is not SUCCESS."""
        return self._ask_managed("on_error", state)

    def _ask_managed(self, name: str, previous: LifecycleState) -> TransitionCallbackReturn:
        for entity in self._managed_entities:
            answer: Any = getattr(entity, name)(previous)
            if not isinstance(answer, TransitionCallbackReturn):
                raise TypeError(f"{name}() of {type(entity)} should return `TransitionCallbackReturn`.")
            if answer != _SUCCESS:
                return answer
        return _SUCCESS

    def _change(self, number: int) -> TransitionCallbackReturn:
        arrow = next((t for t in TRANSITIONS if t.number == number and t.start == self._state), None)
        if arrow is None:
            self._said(f"Unable to start transition {number} from current state {tuple(state(self._state))}")
            return _ERROR
        previous = state(self._state)
        self._enter(arrow.through, arrow)
        answer = self._call(CALLBACKS[arrow.through], previous)
        self._enter(
            {_SUCCESS: arrow.success, _FAILURE: arrow.failure, _ERROR: ERROR_PROCESSING}[answer], arrow
        )
        if answer == _ERROR:
            handled = self._call("on_error", previous)
            self._enter(UNCONFIGURED if handled == _SUCCESS else FINALIZED, arrow)
        return answer

    def _call(self, name: str, previous: LifecycleState) -> TransitionCallbackReturn:
        try:
            answer: TransitionCallbackReturn = getattr(self, name)(previous)
        except Exception as error:
            if getattr(error, "tarl_shutdown", False):
                raise
            self._said(f"{name} raised {type(error).__name__}: {text_of(error)}")
            return _ERROR
        return answer

    def _said(self, message: str) -> None:
        self.get_logger().error(message)  # type: ignore[attr-defined]

    def _enter(self, number: int, arrow: Transition) -> None:
        previous, self._state = self._state, number
        if self._announce is not None:
            event: Any = self._announce.msg_type()
            event.transition.id, event.transition.label = arrow.number, arrow.label
            event.start_state.id, event.start_state.label = previous, LABELS[previous]
            event.goal_state.id, event.goal_state.label = number, LABELS[number]
            self._announce.publish(event)

    def _serve(self) -> None:
        """Create the services for lifecycle managers, and the topic of transition events."""
        made: Any = find_class("ros2", "lifecycle_msgs", "TransitionEvent")
        self._announce = self.create_publisher(made, "~/transition_event", 10)  # type: ignore[attr-defined]
        for kind, name in _SERVICES.items():
            service: Any = find_class("ros2", "lifecycle_msgs", kind, "srv")
            self.create_service(service, f"~/{name}", getattr(self, f"_{name}"))  # type: ignore[attr-defined]

    def _change_state(self, request: Any, response: Any) -> Any:
        number = request.transition.id
        if request.transition.label:
            named = [
                t.number
                for t in TRANSITIONS
                if t.label == request.transition.label and t.start == self._state
            ]
            if not named:
                return response
            number = named[0]
        response.success = self._change(number) == _SUCCESS
        return response

    def _get_state(self, _request: Any, response: Any) -> Any:
        response.current_state.id, response.current_state.label = self._state, LABELS[self._state]
        return response

    def _get_available_states(self, _request: Any, response: Any) -> Any:
        made: Any = find_class("ros2", "lifecycle_msgs", "State")
        response.available_states = [made(id=number, label=label) for number, label in LABELS.items()]
        return response

    def _get_available_transitions(self, _request: Any, response: Any) -> Any:
        made: Any = find_class("ros2", "lifecycle_msgs", "TransitionDescription")
        for arrow in TRANSITIONS:
            if arrow.start == self._state:
                item = made()
                item.transition.id, item.transition.label = arrow.number, arrow.label
                item.start_state.id, item.start_state.label = arrow.start, LABELS[arrow.start]
                item.goal_state.id, item.goal_state.label = arrow.through, LABELS[arrow.through]
                response.available_transitions.append(item)
        return response


class LifecycleNode(LifecycleNodeMixin, Node):
    """A node with a lifecycle."""

    def __init__(
        self, node_name: str, *, enable_communication_interface: bool = True, **options: Any
    ) -> None:
        Node.__init__(self, node_name, **options)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)
