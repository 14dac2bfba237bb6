"""rclpy's Node."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pytest_tarl.ros import names
from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.missing import unsupported, unsupported_name
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from pytest_tarl.ros.rclpy.context import this_context
from pytest_tarl.ros.rclpy.entities import NodeEntities
from pytest_tarl.ros.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from pytest_tarl.ros.rclpy.graph import NodeGraph
from pytest_tarl.ros.rclpy.logging import RcutilsLogger
from pytest_tarl.ros.rclpy.parameter_overrides import overrides
from pytest_tarl.ros.rclpy.parameter_services import offer_parameter_services, parameter_event
from pytest_tarl.ros.rclpy.parameters import NodeParameters
from pytest_tarl.ros.rclpy.qos import as_profile
from pytest_tarl.ros.rclpy.qos_overriding_options import overridden
from pytest_tarl.ros.rclpy.services import Client, Service
from pytest_tarl.ros.rclpy.time import ROSClock
from pytest_tarl.ros.rclpy.timer import Rate, Timer
from pytest_tarl.ros.rclpy.topics import Publisher, Subscription
from pytest_tarl.ros.rclpy.validating import (
    validate_full_topic_name,
    validate_namespace,
    validate_node_name,
    validate_topic_name,
)
from pytest_tarl.ros.rclpy.waitable import GuardCondition, Mailbox

_NOT_YET = frozenset(["add_waitable", "remove_waitable", "get_node_names_and_namespaces_with_enclaves"])


class Node(NodeEntities, NodeGraph, NodeParameters):
    """A node: its name, and functions that create entities. Base classes add entities, graph and parameters."""

    def __init__(
        self,
        node_name: str,
        *,
        context: Any = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Any] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        self.context = this_context("node.Node")
        self.context.require()
        self.process = self.context.process
        self._executor: Any = None
        self._event_publisher: Publisher | None = None
        self._command_line = names.parse_ros2(cli_args) if cli_args else self.context.command_line
        self._name = self._command_line.name or node_name
        validate_node_name(self._name)
        self._namespace = names.absolute(self._command_line.namespace or namespace or "/")
        validate_namespace(self._namespace)
        self._full_name = names.absolute(f"{self._namespace}/{self._name}")
        self._remappings = {**self.process.ros.remappings, **self._command_line.remappings}
        if not self.context.nodes:
            self.process.label = self._full_name
        self.default_callback_group = MutuallyExclusiveCallbackGroup()
        NodeEntities.__init__(self)
        self._clock = ROSClock()
        self._logger = RcutilsLogger(self._full_name.strip("/").replace("/", "."))
        self.context.nodes.append(self)
        given = {parameter.name: parameter.value for parameter in parameter_overrides or ()}
        values = {
            **overrides(self.process.launched.private, self._full_name),
            **overrides(self.process.ros.parameters, self._full_name),
            **overrides(self._command_line.parameters, self._full_name),
        }
        NodeParameters.__init__(self, {**values, **given}, allow_undeclared_parameters)
        for name, value in values.items():
            self.process.ros.read(f"{self._full_name}/{name.replace('.', '/')}", value)
        if automatically_declare_parameters_from_overrides:
            self.declare_all_overrides()
        if start_parameter_services:
            offer_parameter_services(self)

    @property
    def executor(self) -> Any:
        """Return the executor that runs this node's callbacks; assigning one adds the node to it."""
        return self._executor

    @executor.setter
    def executor(self, executor: Any) -> None:
        if self._executor is executor:
            return
        if self._executor is not None:
            self._executor.remove_node(self)
        if executor is not None:
            executor.add_node(self)

    def take_executor(self, executor: Any) -> None:
        """Set the executor that runs this node."""
        self._executor = executor

    def notify(self) -> None:
        """Wake the executor, because an entity became ready."""
        if self._executor is not None:
            self._executor.wake()

    def parameters_changed(self, parameters: list[Any], known: set[str]) -> None:
        """Publish changed parameters on /parameter_events, if it has subscribers."""
        place = self.process.bus.topic("/parameter_events")
        if place.subscriptions or place.listeners:
            event = parameter_event(self, parameters, known)
            if self._event_publisher is None:
                self._event_publisher = Publisher(self, type(event), place, as_profile(1000))
            self._event_publisher.publish(event)

    def get_name(self) -> str:
        """Return the name without namespace."""
        return self._name

    def get_namespace(self) -> str:
        """Return the namespace."""
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return self._full_name

    def get_logger(self) -> RcutilsLogger:
        """Return the node's logger."""
        return self._logger

    def get_clock(self) -> ROSClock:
        """Return the node's clock."""
        return self._clock

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a topic. Raise InvalidTopicNameException."""
        if not isinstance(topic, str):
            raise TypeError(f"topic_name must be a str, not {type(topic).__name__}")
        validate_topic_name(topic)
        if "//" in topic:
            raise InvalidTopicNameException(
                topic, "topic name must not contain repeated '/'", topic.index("//") + 1
            )
        expanded = names.expand(topic, self._full_name)
        validate_full_topic_name(expanded)
        return expanded if only_expand else names.resolve(topic, self._full_name, self._remappings)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a service. Raise InvalidServiceNameException."""
        try:
            return self.resolve_topic_name(service, only_expand=only_expand)
        except InvalidTopicNameException as error:
            raise InvalidServiceNameException(error.name, error.error_msg, error.invalid_index) from None

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: Any,
        *,
        callback_group: Any = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        publisher_class: Any = None,
    ) -> Publisher:
        """Create a publisher."""
        place = self.process.bus.topic(self.resolve_topic_name(topic))
        profile = overridden(self, "publisher", place.name, as_profile(qos_profile), qos_overriding_options)
        made = (publisher_class or Publisher)(self, msg_type, place, profile)
        self.publishers_.append(made)
        return self.publishers_[-1]

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], Any],
        qos_profile: Any,
        *,
        callback_group: Any = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
        content_filter_options: Any = None,
    ) -> Subscription:
        """Create a subscription; raise if a content filter is given, which the bus does not support."""
        if content_filter_options is not None:
            raise unsupported("Node.create_subscription(content_filter_options=…)")
        place = self.process.bus.topic(self.resolve_topic_name(topic))
        group = callback_group or self.default_callback_group
        profile = overridden(
            self, "subscription", place.name, as_profile(qos_profile), qos_overriding_options
        )
        made = Subscription(self, msg_type, place, callback, group, profile, raw)
        self._add(made, self.subscriptions_)
        return made

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[..., Any] | None,
        callback_group: Any = None,
        clock: Any = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer with a period in seconds."""
        period = int(float(timer_period_sec) * NANOSECONDS)
        timer = Timer(self, period, callback, callback_group or self.default_callback_group, clock)
        if not autostart:
            timer.cancel()
        self._add(timer, self.timers_)
        return timer

    def create_rate(self, frequency: float, clock: Any = None) -> Rate:
        """Create a rate in Hz. Raise ValueError unless the frequency is positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(self, frequency)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[..., Any],
        *,
        callback_group: Any = None,
        **_: Any,
    ) -> Service:
        """Create a service."""
        name = self.resolve_service_name(srv_name)
        made = Service(self, srv_type, name, callback, callback_group or self.default_callback_group)
        self._add(made, self.services_)
        return made

    def create_client(self, srv_type: Any, srv_name: str, *, callback_group: Any = None, **_: Any) -> Client:
        """Create a client of a service."""
        name = self.resolve_service_name(srv_name)
        made = Client(self, srv_type, name, callback_group or self.default_callback_group)
        self._add(made, self.clients_)
        return made

    def create_guard_condition(
        self, callback: Callable[[], Any] | None, callback_group: Any = None
    ) -> GuardCondition:
        """Create a guard condition."""
        made = GuardCondition(self, callback, callback_group or self.default_callback_group)
        self._add(made, self.guards_)
        return made

    def create_mailbox(self, callback_group: Any = None) -> Mailbox:
        """Create a mailbox for an action."""
        made = Mailbox(self, callback_group or self.default_callback_group)
        self._add(made, self.waitables_)
        return made

    def _add(self, entity: Any, kind: list[Any]) -> None:
        kind.append(entity)
        entity.callback_group.add_entity(entity)
        self.notify()

    def destroy_node(self) -> None:
        """Destroy the node and all its entities."""
        self.destroy_all()
        if self._executor is not None:
            self._executor.remove_node(self)
        if self in self.context.nodes:
            self.context.nodes.remove(self)

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy_node()

    def __getattr__(self, name: str) -> Any:
        if name in _NOT_YET:
            raise unsupported_name(f"Node.{name}")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
