"""Run an episode on an installed rospy."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from typing import Any

from pytest_tarl.errors import RecordingError
from pytest_tarl.realros.bus import RealBus, RealRos, refused
from pytest_tarl.realros.copies import present, show
from pytest_tarl.realros.lockstep import WireScheduler
from pytest_tarl.realros.rospy_network import RospyNetwork, mismatch, quiet_publisher
from pytest_tarl.realros.rospy_patches import patch
from pytest_tarl.ros.bus import Topic
from pytest_tarl.ros.messages.type_definitions import Kind
from pytest_tarl.ros.process import Process


class RospyBus(RealBus):
    """The world's bus, which has its own rospy node."""

    kind: Kind = "ros1"

    def __init__(self, scheduler: WireScheduler, run: Callable[..., None], network: RospyNetwork) -> None:
        super().__init__(scheduler, run)
        self._network = network
        self._publishers: dict[str, Any] = {}
        self._lanes: dict[tuple[Process, str], Lane] = {}
        network.node_publishes = self._listen
        network.node_subscribes = self.subscribed.add

    def send(self, place: Topic, message: Any, latch: bool) -> None:
        """Publish with rospy. Raise RecordingError if the message is invalid or a subscriber has another type."""
        publisher = self._publisher(place.name, type(message))
        for copy, subscriber in self._network.subscribers(place.name):
            if copy.process is not None and subscriber.callbacks and mismatch(publisher.impl, subscriber):
                raise refused(place.name, type(message), copy.name, subscriber.data_class)
        kept = publisher.impl.latch
        publisher.impl.is_latch = latch
        try:
            publisher.publish(message)
        except self._network.world.rospy.ROSSerializationException as error:
            raise RecordingError(f"The message published on {place.name} is not valid: {error}.") from error
        if not latch:
            publisher.impl.is_latch, publisher.impl.latch = kept is not None, kept

    def collect(self) -> bool:
        """Receive one message in transit; return whether there was one."""
        taken = self._network.wire.take()
        if taken is None:
            return False
        way, (subscriber, message) = taken
        world = self._network.world
        if way.receiver == world.name:
            if way.sender != world.name:
                self.heard(way.topic, message)
            return True
        copy = next((copy for copy, end in self._network.subscribers(way.topic) if end is subscriber), None)
        if copy is not None and copy.process is not None:
            self._lane(copy.process, way.topic, subscriber).deliver(message)
            self._network.wake_listening()
        return True

    def _publisher(self, topic: str, message_class: Any) -> Any:
        if topic not in self._publishers:
            self._publishers[topic] = quiet_publisher(self._network.world, topic, message_class)
        return self._publishers[topic]

    def _listen(self, topic: str, message_class: Any) -> None:
        """Subscribe the world to a topic before a node publishes on it."""
        self._network.world.rospy.Subscriber(topic, message_class)

    def _lane(self, process: Process, topic: str, subscriber: Any) -> Lane:
        key = (process, topic)
        if key not in self._lanes:
            self._lanes[key] = Lane(process, subscriber)
        return self._lanes[key]


class Lane:
    """A node's callbacks for one topic; they handle one message at a time, as in rospy's thread."""

    def __init__(self, process: Process, subscriber: Any) -> None:
        self._process = process
        self._subscriber = subscriber
        self._waiting: deque[Any] = deque()
        self._busy = False

    def deliver(self, message: Any) -> None:
        """Call the callbacks with a message, or queue it while they handle an earlier one."""
        if self._process.ending:
            return
        self._waiting.append(message)
        capacity = self._subscriber.queue_size
        if not self._busy:
            self._process.scheduler.spawn(self._process, self._work)
        elif capacity and len(self._waiting) > capacity:
            self._waiting.popleft()

    def _work(self) -> None:
        self._busy = True
        try:
            while self._waiting and not self._process.ending:
                message = self._waiting.popleft()
                for callback, arguments in self._subscriber.callbacks:
                    if arguments is None:
                        callback(message)
                    else:
                        callback(message, arguments)
        finally:
            self._busy = False


class RospyRos(RealRos):
    """An episode whose nodes import the installed rospy."""

    def __init__(self, *, parameters: Mapping[str, Any] | None = None, **options: Any) -> None:
        super().__init__(parameters=parameters, **options)
        _silence_rospy()
        self.network = rospy_network()
        self.bus = RospyBus(self.lockstep, self._run, self.network)
        self._shown: Process | None = None
        self._begun = False

    def start(self, run: Callable[[], None], *, name: str, argv: Sequence[str] = ()) -> None:
        """Run a node's main program until it first waits."""
        if not self._begun:
            self._begun = True
            self.network.begin(self.lockstep, self.parameters)
        remapped = [f"{old}:={new}" for old, new in self.remappings.items()]
        super().start(run, name=name, argv=[*argv, *remapped])

    def enter(self, process: Process) -> None:
        """Make `import rospy` return this process's copy."""
        if process is not self._shown:
            self.network.enter(process)
            self.network.copy_of(process).show()
            self._shown = process

    def close(self) -> None:
        """End every node, then clean up the episode."""
        if self.closed:
            return
        try:
            super().close()
        finally:
            self.network.end()

    @contextmanager
    def _installed(self) -> Iterator[None]:
        before = present("rospy")
        try:
            with super()._installed():
                yield
        finally:
            show("rospy", before)


@cache
def rospy_network() -> RospyNetwork:
    """Return the network of this test run; start it when first needed."""
    return RospyNetwork(patch)


def close_network() -> None:
    """Stop all processes and nodes of the test run."""
    if rospy_network.cache_info().currsize:
        rospy_network().close()
        rospy_network.cache_clear()


def _silence_rospy() -> None:
    """Ignore warnings from rospy's code: with `-W error`, they would end rospy's threads."""
    for module in ("rospy", "rosgraph", "roslib", "genpy"):
        warnings.filterwarnings("ignore", category=DeprecationWarning, module=rf"{module}(\.|$)")
