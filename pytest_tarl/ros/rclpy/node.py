"""rclpy's Node."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from pytest_tarl.ros import names
from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.missing import unsupported
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from pytest_tarl.ros.rclpy.context import this_context
from pytest_tarl.ros.rclpy.entities import NodeEntities
from pytest_tarl.ros.rclpy.exceptions import InvalidNodeNameException, InvalidTopicNameException
from pytest_tarl.ros.rclpy.logging import RcutilsLogger
from pytest_tarl.ros.rclpy.parameters import NodeParameters
from pytest_tarl.ros.rclpy.qos import as_profile
from pytest_tarl.ros.rclpy.services import Client, Service
from pytest_tarl.ros.rclpy.time import ROSClock
from pytest_tarl.ros.rclpy.timer import Rate, Timer
from pytest_tarl.ros.rclpy.topics import Publisher, Subscription

_TOPIC = re.compile(r"[~/]?[A-Za-z_{}][\w{}]*(/[A-Za-z_{}][\w{}]*)*|~/[\w{}/]+")
_NOT_YET = frozenset(
    [
        "create_guard_condition",
        "get_publishers_info_by_topic",
        "get_subscriptions_info_by_topic",
        "add_waitable",
        "create_entity",
        "get_client_names_and_types_by_node",
        "get_service_names_and_types",
        "get_publisher_names_and_types_by_node",
        "wait_for_node",
        "get_subscriber_names_and_types_by_node",
        "get_service_names_and_types_by_node",
        "add_pre_set_parameters_callback",
        "describe_parameter",
        "describe_parameters",
        "set_descriptor",
    ]
)


class Node(NodeEntities, NodeParameters):
    """A node: its name, what it creates and holds, and its parameters (the base classes)."""

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
        self.executor: Any = None
        self._command_line = names.parse_ros2(cli_args) if cli_args else self.context.command_line
        self._name = self._command_line.name or node_name
        if not re.fullmatch(r"[A-Za-z_]\w*", self._name):
            raise InvalidNodeNameException(f"Invalid node name: {self._name!r}")
        self._namespace = names.absolute(self._command_line.namespace or namespace or "/")
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
        overrides = {
            **self._overrides(self.process.ros.parameters),
            **self._overrides(self._command_line.parameters),
        }
        NodeParameters.__init__(self, {**overrides, **given}, allow_undeclared_parameters)
        if automatically_declare_parameters_from_overrides:
            self.declare_all_overrides()

    def notify(self) -> None:
        """Tell the executor that something became ready."""
        if self.executor is not None:
            self.executor.wake()

    def _overrides(self, given: Any) -> dict[str, Any]:
        """Pick what is meant for this node: plain names, and those under its own name or `/**`."""
        chosen: dict[str, Any] = {}
        for key, value in given.items():
            owner = key.strip("/")
            if isinstance(value, dict) and owner in (self._name, self._full_name.strip("/"), "**"):
                chosen.update(_flat(value.get("ros__parameters", value)))
            elif ":" in key:
                node, _, name = key.partition(":")
                if node.strip("/") in (self._name, self._full_name.strip("/")):
                    chosen[name] = value
            elif not key.startswith("/"):
                chosen[key.removeprefix("~")] = value
        return chosen

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
        """Return the absolute name of a topic."""
        if not isinstance(topic, str) or not _TOPIC.fullmatch(topic):
            raise InvalidTopicNameException(f"Invalid topic name: {topic!r}")
        if only_expand:
            return names.expand(topic, self._full_name)
        return names.resolve(topic, self._full_name, self._remappings)

    resolve_service_name = resolve_topic_name

    def create_publisher(
        self, msg_type: Any, topic: str, qos_profile: Any, *, callback_group: Any = None, **_: Any
    ) -> Publisher:
        """Create a publisher."""
        place = self.process.bus.topic(self.resolve_topic_name(topic))
        self.publishers_.append(Publisher(self, msg_type, place, as_profile(qos_profile)))
        return self.publishers_[-1]

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], Any],
        qos_profile: Any,
        *,
        callback_group: Any = None,
        raw: bool = False,
        **_: Any,
    ) -> Subscription:
        """Create a subscription."""
        if raw:
            raise unsupported("Node.create_subscription(raw=True)")
        place = self.process.bus.topic(self.resolve_topic_name(topic))
        group = callback_group or self.default_callback_group
        made = Subscription(self, msg_type, place, callback, group, as_profile(qos_profile))
        self.subscriptions_.append(made)
        self.notify()
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
        timer = Timer(self, period, callback, callback_group or self.default_callback_group)
        if not autostart:
            timer.cancel()
        self.timers_.append(timer)
        self.notify()
        return timer

    def create_rate(self, frequency: float, clock: Any = None) -> Rate:
        """Create a rate in Hz."""
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
        self.services_.append(
            Service(self, srv_type, name, callback, callback_group or self.default_callback_group)
        )
        return self.services_[-1]

    def create_client(self, srv_type: Any, srv_name: str, *, callback_group: Any = None, **_: Any) -> Client:
        """Create a client of a service."""
        name = self.resolve_service_name(srv_name)
        self.clients_.append(Client(self, srv_type, name, callback_group or self.default_callback_group))
        return self.clients_[-1]

    def count_publishers(self, topic_name: str) -> int:
        """Return how many publish on a topic. The simulated world counts as one."""
        return 1 + len(self.process.bus.topic(self.resolve_topic_name(topic_name)).publications)

    def count_subscribers(self, topic_name: str) -> int:
        """Return how many subscribe to a topic. The simulated world counts as one."""
        return 1 + len(self.process.bus.topic(self.resolve_topic_name(topic_name)).subscriptions)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        """List topics that nodes publish on."""
        return [
            (place.name, sorted({p.type.replace("/", "/msg/") for p in place.publications}))
            for place in self.process.bus.topics()
            if place.publications
        ]

    def get_node_names(self) -> list[str]:
        """List the nodes of this program."""
        return [node.get_name() for node in self.context.nodes]

    def destroy_node(self) -> None:
        """Destroy the node and all that it created."""
        self.destroy_all()
        if self.executor is not None:
            self.executor.remove_node(self)
        if self in self.context.nodes:
            self.context.nodes.remove(self)

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy_node()

    def __getattr__(self, name: str) -> Any:
        if name in _NOT_YET:
            raise unsupported(f"Node.{name}")
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")


def _flat(tree: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in tree.items():
        flat.update(_flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value})
    return flat
