"""Run an episode on an installed rclpy."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

from pytest_tarl.realros.bus import RealBus, RealRos, refused
from pytest_tarl.realros.lockstep import WireScheduler
from pytest_tarl.realros.rclpy_network import RclpyNetwork
from pytest_tarl.realros.rclpy_patches import patch
from pytest_tarl.ros.bus import Topic
from pytest_tarl.ros.messages.type_definitions import Kind
from pytest_tarl.ros.process import Process

_DEPTH = 1_000  # queue length of the world's publishers and subscriptions


class RclpyBus(RealBus):
    """The world's bus, which has its own rclpy node."""

    kind: Kind = "ros2"

    def __init__(self, scheduler: WireScheduler, run: Callable[..., None], network: RclpyNetwork) -> None:
        super().__init__(scheduler, run)
        self._network = network
        self._publishers: dict[tuple[str, bool], Any] = {}

    def send(self, place: Topic, message: Any, latch: bool) -> None:
        """Publish with rclpy. Raise RecordingError if a subscriber has another message type."""
        for _, node in self._network.nodes:
            for subscription in node.subscriptions:
                if subscription.topic_name == place.name and subscription.msg_type is not type(message):
                    raise refused(place.name, type(message), node.get_name(), subscription.msg_type)
        self._publisher(place.name, type(message), latch).publish(message)

    def listen(self, topic: str, message_class: Any, profile: Any) -> None:
        """Subscribe the world to a topic before a node publishes on it."""
        world, qos = self._network.world, self._network.rclpy.qos
        if all(one.topic_name != topic for one in world.subscriptions):
            own = qos.QoSProfile(
                depth=_DEPTH, reliability=profile.reliability, durability=qos.DurabilityPolicy.VOLATILE
            )
            world.create_subscription(message_class, topic, _nothing, own)

    def collect(self) -> bool:
        """Receive one message for the world; return whether there was one."""
        taken = self._network.take_for_world()
        if taken is None:
            return False
        self.heard(*taken)
        return True

    def _publisher(self, topic: str, message_class: Any, latch: bool) -> Any:
        """Return the world's publisher.

        It is transient local with depth 1 if it latches, or if a subscription requires this.
        """
        qos = self._network.rclpy.qos
        wanted = [
            subscription.qos_profile
            for _, node in self._network.nodes
            for subscription in node.subscriptions
            if subscription.topic_name == topic
        ]
        keep = latch or any(one.durability == qos.DurabilityPolicy.TRANSIENT_LOCAL for one in wanted)
        if (topic, keep) not in self._publishers:
            first = wanted[0] if wanted else qos.QoSProfile(depth=1)
            durability = qos.DurabilityPolicy.TRANSIENT_LOCAL if keep else qos.DurabilityPolicy.VOLATILE
            profile = qos.QoSProfile(
                depth=1 if keep else _DEPTH,
                reliability=qos.ReliabilityPolicy.RELIABLE,
                durability=durability,
                deadline=first.deadline,
                liveliness=first.liveliness,
                liveliness_lease_duration=first.liveliness_lease_duration,
            )
            self._publishers[topic, keep] = self._network.world.create_publisher(
                message_class, topic, profile
            )
        return self._publishers[topic, keep]


class RclpyRos(RealRos):
    """An episode whose nodes import the installed rclpy."""

    def __init__(self, *, parameters: Mapping[str, Any] | None = None, **options: Any) -> None:
        super().__init__(parameters=parameters, **options)
        self.network = rclpy_network()
        bus = RclpyBus(self.lockstep, self._run, self.network)
        self.bus = bus
        self.network.node_publishes = bus.listen
        self.network.node_subscribes = self.bus.subscribed.add
        self._shown: Process | None = None
        self._known: set[Process] = set()
        self.network.begin(self.lockstep, self.parameters)

    def start(self, run: Callable[[], None], *, name: str, argv: Sequence[str] = ()) -> None:
        """Run a node's main program until it first waits."""
        self.network.begin(self.lockstep, self.parameters)
        remapped = [part for old, new in self.remappings.items() for part in ("-r", f"{old}:={new}")]
        extra = ["--ros-args", *remapped] if remapped else []
        super().start(run, name=name, argv=[*argv, *extra])

    def enter(self, process: Process) -> None:
        """Set the process's default context, and the clocks."""
        if process is not self._shown:
            self.network.enter(process, self._shown)
            self._shown = process
        if process not in self._known:
            self._known.add(process)
            process.at_end(self.network.stop_contexts(process))
        self.network.tell_time()

    def close(self) -> None:
        """End every node, then clean up the episode."""
        if self.closed:
            return
        try:
            super().close()
        finally:
            self.network.end()


@cache
def rclpy_network() -> RclpyNetwork:
    """Return the network of this test run; start it when first needed."""
    with warnings.catch_warnings():
        # these warnings come from imports in rclpy, where users cannot fix them
        warnings.simplefilter("ignore", DeprecationWarning)
        network = RclpyNetwork()
        patch(network)
    return network


def close_network() -> None:
    """Shut the network down."""
    if rclpy_network.cache_info().currsize:
        rclpy_network().close()
        rclpy_network.cache_clear()


def _nothing(_message: Any) -> None:
    """Do nothing: `collect` takes the world's messages one by one."""
