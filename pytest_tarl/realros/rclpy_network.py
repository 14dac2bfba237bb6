"""The ROS 2 network of a test run: one participant for all episodes, the world's node, and messages in transit."""

from __future__ import annotations

import os
import random
from collections import Counter, deque
from collections.abc import Callable, Mapping
from time import monotonic, sleep
from types import ModuleType
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.realros.lockstep import PATIENCE, WireScheduler
from pytest_tarl.realros.rclpy_arrivals import silent
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Task

WORLD = "tarl_world"
_DOMAINS = range(1, 100)  # domains whose ports are below the kernel's ephemeral range
_PAUSE = 0.0001  # polling period while waiting for a sent message (wall time in s)


class RclpyNetwork:
    """The network of a test run. All nodes share a process and a participant, so no discovery is needed."""

    def __init__(self) -> None:
        self._environment = _own_domain()
        import rclpy
        from rclpy.context import Context
        from rclpy.node import Node

        self.rclpy: ModuleType = rclpy
        self.context = Context()
        self.context.init(args=[WORLD])
        self.world = Node(WORLD, context=self.context, start_parameter_services=False, enable_rosout=False)
        self.scheduler = WireScheduler()
        self.parameters: Mapping[str, Any] = {}
        self.arguments: tuple[str, ...] = ()
        self.listening: list[Task] = []  # tasks to wake when a message arrives
        self.nodes: list[tuple[Process, Any]] = []
        self.clocks: list[Any] = []
        self.contexts: list[Any] = []
        # a node's subscription → number of messages in transit to it
        self.expected: Counter[Any] = Counter()
        self.kept: Counter[Any] = Counter()  # number of messages that publishers keep for late subscribers
        self.for_world: deque[Any] = (
            deque()
        )  # for each message in transit to the world, the world's subscription
        self.node_publishes: Callable[[str, Any, Any], None] | None = None
        self.node_subscribes: Callable[[str], None] | None = None
        self._state: dict[Process, dict[str, Any]] = {}
        self._told = -1

    def close(self) -> None:
        """Shut the network down."""
        self.world.destroy_node()
        self.context.try_shutdown()
        for name, value in self._environment.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value

    def begin(self, scheduler: WireScheduler, parameters: Mapping[str, Any]) -> None:
        """Start an episode."""
        self.scheduler, self.parameters = scheduler, parameters
        self._told = -1

    def end(self) -> None:
        """Destroy the remaining entities of the episode's nodes."""
        for _, node in self.nodes:
            node.destroy_node()
        for entity in (*self.world.subscriptions, *self.world.publishers):
            entity.destroy()
        self.world._subscriptions.clear()
        self.world._publishers.clear()
        for kept in (self.nodes, self.clocks, self.contexts, self.listening, self.for_world):
            kept.clear()
        self.expected.clear()
        self.kept.clear()
        self._state.clear()

    def enter(self, process: Process, before: Process | None) -> None:
        """Set rclpy's default context and executor to those of the process."""
        if before is not None:
            self._state[before] = self._globals()
        state = self._state.pop(process, {"context": None, "executor": None})
        self.rclpy.utilities.__dict__["g_default_context"] = state["context"]
        self.rclpy.__dict__["__executor"] = state["executor"]

    def stop_contexts(self, process: Process) -> Callable[[], None]:
        """Return a function that shuts ROS down in a process."""

        def stop() -> None:
            for context in tuple(self.contexts):
                if context.process is process:
                    context.stop()
            self.wake_listening()

        return stop

    def tell_time(self) -> None:
        """Set the ROS clocks of all nodes to virtual time."""
        now = self.scheduler.time
        if now == self._told:
            return
        self._told = now
        for clock in self.clocks:
            clock.set_ros_time_override(self.rclpy.time.Time(nanoseconds=now, clock_type=clock.clock_type))

    def wake_listening(self) -> None:
        """Wake tasks that wait for a message."""
        tasks, self.listening = self.listening, []
        for task in tasks:
            self.scheduler.wake(task)

    def sent(self, publisher: Any) -> None:
        """Count a sent message as in transit to every matching subscription."""
        if publisher.qos_profile.durability.name == "TRANSIENT_LOCAL":
            self.kept[publisher] = min(self.kept[publisher] + 1, capacity(publisher.qos_profile))
        for subscription in self.matched(publisher):
            if subscription in self.world._subscriptions:
                self.for_world.append(subscription)
            else:
                self.expected[subscription] = min(
                    self.expected[subscription] + 1, capacity(subscription.qos_profile)
                )
        self.scheduler.sent()
        self.wake_listening()

    def joined(self, subscription: Any) -> None:
        """Count the messages that publishers keep as in transit to a new subscription.

        Wait until all of them are sent. Otherwise the node might take a newer message first, and then receive old ones
        that a short queue would have dropped.
        """
        if subscription.qos_profile.durability.name != "TRANSIENT_LOCAL":
            return
        for publisher, kept in self.kept.items():
            if subscription in self.matched(publisher):
                publisher.wait_for_all_acked(self.rclpy.duration.Duration(seconds=PATIENCE))
                most = capacity(subscription.qos_profile)
                self.expected[subscription] = min(self.expected[subscription] + kept, most)

    def taken(self, subscription: Any) -> None:
        """Count a message that an executor takes."""
        if self.expected[subscription] > 0:
            self.expected[subscription] -= 1

    def under_way(self, executor: Any) -> bool:
        """Return whether a message to one of the executor's nodes is still in transit.

        The executor must wait for it; otherwise thread timing would decide which of two topics comes first.
        """
        expecting = [
            subscription
            for node in executor.get_nodes()
            for subscription in node.subscriptions
            if self.expected[subscription] > 0 and executor.can_execute(subscription)
        ]
        return bool(expecting and silent(self.rclpy, executor.context, expecting))

    def take_for_world(self) -> tuple[str, Any] | None:
        """Wait for the oldest message in transit to the world.

        Return (topic, message); None if no message is in transit.

        Raise RecordingError if the message does not arrive within PATIENCE.
        """
        if not self.for_world:
            return None
        subscription = self.for_world.popleft()
        deadline = monotonic() + PATIENCE
        while monotonic() < deadline:
            with subscription.handle:
                found = subscription.handle.take_message(subscription.msg_type, False)
            if found is not None:
                return subscription.topic_name, found[0]
            pause()
        raise RecordingError(
            f"A message on {subscription.topic_name} did not reach the world within {PATIENCE:g} s: check that "
            "processes on this machine can communicate through 127.0.0.1."
        )

    def matched(self, publisher: Any) -> list[Any]:
        """Return the subscriptions connected to a publisher."""
        topic = publisher.topic_name
        return [
            subscription
            for node in (self.world, *(node for _, node in self.nodes))
            for subscription in node.subscriptions
            if subscription.topic_name == topic
            and subscription.msg_type is publisher.msg_type
            and self.compatible(publisher.qos_profile, subscription.qos_profile)
        ]

    def compatible(self, offered: Any, requested: Any) -> bool:
        """Return whether the middleware would connect two QoS profiles."""
        answer, _ = self.rclpy.qos.qos_check_compatible(offered, requested)
        return bool(answer != self.rclpy.qos.QoSCompatibility.ERROR)

    def _globals(self) -> dict[str, Any]:
        return {
            "context": self.rclpy.utilities.__dict__["g_default_context"],
            "executor": self.rclpy.__dict__["__executor"],
        }


def capacity(profile: Any) -> int:
    """Return the queue length of a subscription."""
    keeps_all = profile.history.name == "KEEP_ALL"
    return 1_000_000 if keeps_all else max(1, int(profile.depth))


def pause(_sleep: Any = sleep) -> None:
    """Sleep for _PAUSE of wall time, to let the middleware's threads run."""
    _sleep(_PAUSE)


def _own_domain() -> dict[str, str | None]:
    """Restrict ROS to this machine and a random domain. Return the environment variables as they were."""
    wanted = {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": str(random.SystemRandom().choice(_DOMAINS)),
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",  # shared memory would leave files in /dev/shm after a crash
    }
    before = {name: os.environ.get(name) for name in wanted}
    os.environ.update(wanted)
    return before
