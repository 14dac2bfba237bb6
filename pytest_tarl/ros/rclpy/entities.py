"""The entities of a node: publishers, subscriptions, timers, clients, services."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pytest_tarl.ros.rclpy.services import Client, Service
from pytest_tarl.ros.rclpy.timer import Rate, Timer
from pytest_tarl.ros.rclpy.topics import Publisher, Subscription
from pytest_tarl.ros.rclpy.waitable import GuardCondition, Mailbox


class NodeEntities:
    """Mixin of Node: list and destroy the node's entities."""

    def __init__(self) -> None:
        self.publishers_: list[Publisher] = []
        self.subscriptions_: list[Subscription] = []
        self.timers_: list[Timer] = []
        self.clients_: list[Client] = []
        self.services_: list[Service] = []
        self.guards_: list[GuardCondition] = []
        self.waitables_: list[Mailbox] = []
        self.entities: tuple[list[Any], ...] = (  # entities that an executor can run, in rclpy's order
            self.timers_, self.subscriptions_, self.guards_, self.clients_, self.services_, self.waitables_,
        )  # fmt: skip

    @property
    def publishers(self) -> Iterator[Any]:
        """The node's publishers."""
        return iter(self.publishers_)

    @property
    def subscriptions(self) -> Iterator[Any]:
        """The node's subscriptions."""
        return iter(self.subscriptions_)

    @property
    def timers(self) -> Iterator[Any]:
        """The node's timers."""
        return iter(self.timers_)

    @property
    def clients(self) -> Iterator[Any]:
        """The node's clients."""
        return iter(self.clients_)

    @property
    def services(self) -> Iterator[Any]:
        """The node's services."""
        return iter(self.services_)

    @property
    def guards(self) -> Iterator[Any]:
        """The node's guard conditions."""
        return iter(self.guards_)

    @property
    def waitables(self) -> Iterator[Any]:
        """The waitables of the node's actions."""
        return iter(self.waitables_)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy a publisher."""
        return _destroy(publisher, self.publishers_)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription."""
        return _destroy(subscription, self.subscriptions_)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer."""
        return _destroy(timer, self.timers_)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client."""
        return _destroy(client, self.clients_)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service."""
        return _destroy(service, self.services_)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition."""
        return _destroy(guard, self.guards_)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate."""
        rate.destroy()
        return True

    def destroy_all(self) -> None:
        """Destroy everything."""
        for entities in (self.publishers_, *self.entities):
            for entity in tuple(entities):
                _destroy(entity, entities)


def _destroy(entity: Any, entities: Any) -> bool:
    if entity not in entities:
        return False
    entities.remove(entity)
    entity.destroy()
    return True
