"""A node's queries about the ROS graph: nodes, publishers, subscriptions, services."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.messages.snapshot import type_name
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.scheduler import current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Process

NamesAndTypes = list[tuple[str, list[str]]]


class TopicEndpointTypeEnum(IntEnum):
    """The kind of a topic's end: publisher or subscription."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """One publisher or subscription of a topic."""

    node_name: str = ""
    node_namespace: str = ""
    topic_type: str = ""
    endpoint_type: TopicEndpointTypeEnum = TopicEndpointTypeEnum.INVALID
    endpoint_gid: list[int] = field(default_factory=list)
    qos_profile: Any = None


class NodeGraph:
    """Mixin of Node: graph queries. The simulated world is not a node, but counts as publisher and subscriber."""

    process: Process

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the absolute name of a topic."""
        raise NotImplementedError

    def count_publishers(self, topic_name: str) -> int:
        """Return the number of publishers on a topic. The simulated world counts as one."""
        asked()
        return 1 + len(self.process.bus.topic(self.resolve_topic_name(topic_name)).publications)

    def count_subscribers(self, topic_name: str) -> int:
        """Return the number of subscriptions to a topic. The simulated world counts as one."""
        asked()
        return 1 + len(self.process.bus.topic(self.resolve_topic_name(topic_name)).subscriptions)

    def count_services(self, service_name: str) -> int:
        """Return the number of servers of a service: one or none."""
        return int(self.resolve_topic_name(service_name) in self.process.ros.services)

    def count_clients(self, service_name: str) -> int:
        """Return the number of clients of a service."""
        name = self.resolve_topic_name(service_name)
        return sum(client.srv_name == name for node in self._all() for client in node.clients_)

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """Return the topics that nodes publish on or subscribe to, with types."""
        return [(place.name, types) for place in self.process.bus.topics() if (types := _types(place))]

    def get_service_names_and_types(self) -> NamesAndTypes:
        """Return the services with types."""
        return [(n, [_service_type(made)]) for n, made in self.process.ros.services.names()]

    def get_node_names(self) -> list[str]:
        """Return the names of the episode's nodes."""
        return [node.get_name() for node in self._all()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """Return the names of the episode's nodes, with namespaces."""
        return [node.get_fully_qualified_name() for node in self._all()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return the names and namespaces of the episode's nodes."""
        return [(node.get_name(), node.get_namespace()) for node in self._all()]

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics that a node publishes on, with types."""
        node = self._find(node_name, node_namespace)
        return [(p.topic_name, [_message_type(p.msg_type)]) for p in node.publishers_]

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics that a node subscribes to, with types."""
        node = self._find(node_name, node_namespace)
        return [(s.topic_name, [_message_type(s.msg_type)]) for s in node.subscriptions_]

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services that a node offers, with types."""
        return [
            (s.srv_name, [_service_type(s.srv_type)]) for s in self._find(node_name, node_namespace).services_
        ]

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services that a node has clients for, with types."""
        return [
            (c.srv_name, [_service_type(c.srv_type)]) for c in self._find(node_name, node_namespace).clients_
        ]

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the publishers on a topic."""
        name = self.resolve_topic_name(topic_name)
        return [
            _info(node, publisher, TopicEndpointTypeEnum.PUBLISHER)
            for node in self._all()
            for publisher in node.publishers_
            if publisher.topic_name == name
        ]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """Describe the subscriptions to a topic."""
        name = self.resolve_topic_name(topic_name)
        return [
            _info(node, subscription, TopicEndpointTypeEnum.SUBSCRIPTION)
            for node in self._all()
            for subscription in node.subscriptions_
            if subscription.topic_name == name
        ]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait for a node; return whether it appeared within `timeout` seconds."""
        clock = self.process.scheduler
        until = clock.time + nanoseconds(timeout)
        wanted = "/" + fully_qualified_node_name.lstrip("/")
        current_task()
        while wanted not in self.get_fully_qualified_node_names():
            if clock.time >= until or self.process.ending:
                return False
            clock.wait(min(until, clock.time + nanoseconds(0.1)))
        return True

    def _all(self) -> list[Any]:
        from pytest_tarl.ros.rclpy.context import Context

        contexts = [process.part(Context) for process in self.process.ros.processes if not process.ended]
        return [node for context in contexts for node in context.nodes]

    def _find(self, node_name: str, node_namespace: str) -> Any:
        for node in self._all():
            if node.get_name() == node_name and node.get_namespace() == node_namespace:
                return node
        raise NodeNameNonExistentError(
            f"Cannot get information about node {node_namespace}/{node_name}: it does not exist"
        )


class NodeNameNonExistentError(RuntimeError):
    """There is no node of this name."""


def _types(place: Any) -> list[str]:
    ends = {p.type for p in place.publications} | {type_name(s.message_type) for s in place.subscriptions}
    return sorted(name.replace("/", "/msg/") for name in ends)


def _message_type(made: Any) -> str:
    return type_name(made).replace("/", "/msg/")


def _service_type(made: Any) -> str:
    return f"{made.__module__.partition('.')[0]}/srv/{made.__name__}"


def _info(node: Any, end: Any, kind: TopicEndpointTypeEnum) -> TopicEndpointInfo:
    return TopicEndpointInfo(
        node.get_name(), node.get_namespace(), _message_type(end.msg_type), kind, [], end.qos_profile
    )
