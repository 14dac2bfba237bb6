"""The topics of an episode: publications, subscriptions, and the order in which messages arrive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Protocol

from pytest_tarl.errors import RecordingError, UnsupportedApiError
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import snapshot, stamp_if_unset, type_name
from pytest_tarl.ros.names import absolute, given_name
from pytest_tarl.ros.scheduler import Program, Scheduler, running_task
from pytest_tarl.ros.services import Reply, ServiceDirectory

Listener = Callable[[Any], None]
Channel = Callable[
    [Any, float], Iterable[tuple[float, Any]]
]  # (message, time (s)) → (delay (s), message) for each message that arrives


class Subscription(Protocol):
    """A node's end of a subscribed topic."""

    message_type: type | None  # None accepts every type

    @property
    def process(self) -> Program:
        """The process that subscribes."""

    def deliver(self, message: Any, origin: Publication | None = None) -> None:
        """Receive a message; `origin` is None if the world sent it. Call this outside all tasks.

        The caller must not keep a reference to the message.
        """


class Publication(Protocol):
    """A node's end of a published topic."""

    type: str

    @property
    def process(self) -> Program:
        """The process that publishes."""


class Topic:
    """A topic; `kept` has the messages for later subscribers (latched, transient local)."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.subscriptions: list[Subscription] = []
        self.publications: list[Publication] = []
        self.listeners: list[Listener] = []
        self.latest: Any = None
        self.kept: dict[Any, Any] = {}
        self.channels: list[Channel] = []  # fault injectors that each message passes through
        self.carried = False  # whether anything has been published


class Bus:
    """The world's access to topics and services, one object per episode."""

    def __init__(
        self, scheduler: Scheduler, run: Callable[..., None], services: ServiceDirectory | None = None
    ) -> None:
        self._services = services  # None for --tarl-ros=real, which has its own services
        self._scheduler = scheduler
        self._run = run
        self._topics: dict[str, Topic] = {}
        self._by_spelling: dict[str, Topic] = {}
        self._observers: list[Callable[[str, Any], None]] = []
        self.muted = False  # whether messages from the world are discarded
        self.published: Counter[str] = Counter()
        # called with topic and message when a node publishes
        self.emitted: Callable[[str, Any], None] | None = None
        self.subscribed: set[str] = set()

    def publish(self, topic: str, message: Any, *, latch: bool = False) -> None:
        """Publish from the world; every idle subscriber receives a copy before this method returns.

        Busy subscribers receive it in a later `step`. A header stamp of zero becomes the current time. `latch` keeps
        the message for later subscribers.

        Raise NodeError if a callback raises, and RecordingError if the message has the wrong type.
        """
        place = self.topic(topic)
        if self.muted:
            return
        try:
            message = snapshot(message)
        except FieldError as error:
            raise RecordingError(f"The message published on {place.name} is not valid: {error}.") from error
        stamp_if_unset(message, self._scheduler.time)
        place.carried = True
        if place.channels:
            self._pass(place, message, lambda one: self._deliver(place, one, False))
            return
        if latch:
            place.kept[None] = snapshot(message)
        # a node is publishing: deliver the message after its task has paused
        if running_task() is not None:
            self._scheduler.later(lambda: self._deliver(place, message, spare=True))
            return
        self._run(self._deliver, place, message, True)

    def latest(self, topic: str) -> Any | None:
        """Return the newest message published by a node on the topic, or None before the first one."""
        return self.topic(topic).latest

    def subscribe(self, topic: str, callback: Listener) -> None:
        """Call the world's `callback` with every message published by a node on the topic.

        Raise RecordingError if it is not callable.
        """
        if not callable(callback):
            raise RecordingError(f"tarl.bus.subscribe({topic!r}, …): {callback!r} is not callable.")
        self.topic(topic).listeners.append(callback)

    def observe(self, observer: Callable[[str, Any], None]) -> None:
        """Call `observer` with topic and message before any subscriber receives the message."""
        self._observers.append(observer)

    def serve(self, service: str, service_type: Any, handler: Callable[[Any], Any]) -> None:
        """Serve a service from the world; `handler(request)` returns the response."""
        self._own_services("serve").serve(service, service_type, handler)

    def call(self, service: str, request: Any) -> Reply:
        """Call a node's service from the world; the reply is `done` once the node has answered.

        An idle node answers before this method returns, a busy node during a later `step`.

        Raise RecordingError if no node serves it.
        """
        services = self._own_services("call")
        reply: list[Reply | None] = []
        if running_task() is not None:
            reply.append(services.call(service, request))
        else:
            self._run(lambda: reply.append(services.call(service, request)))
        if reply[0] is None:
            names = [name for name, _ in services.names()]
            raise RecordingError(
                f"No node serves {absolute(service)} now; available services: {', '.join(names) or 'none'}."
            )
        return reply[0]

    def _own_services(self, what: str) -> ServiceDirectory:
        if self._services is None:
            raise UnsupportedApiError(
                f"tarl.bus.{what} works with --tarl-ros=embedded only: on a real ROS, start a small node "
                "in the test that calls or offers the service."
            )
        return self._services

    def topic(self, name: str) -> Topic:
        """Return the topic with that name; create it on first use."""
        found = self._by_spelling.get(name)
        if found is None:
            resolved = given_name(name)
            found = self._topics.setdefault(resolved, Topic(resolved))
            self._by_spelling[name] = found
        return found

    def topics(self) -> list[Topic]:
        """Return all topics in the order of their first use."""
        return list(self._topics.values())

    def publish_from(self, publication: Publication, place: Topic, message: Any, *, keep: int = 0) -> None:
        """Publish a copy: the world gets it at once, other nodes when this node waits."""
        message = snapshot(message)
        self.published[place.name] += 1
        if self.emitted is not None:
            self.emitted(place.name, message)
        place.carried = True
        if place.channels:
            self._pass(place, message, lambda one: self._emit(publication, place, one, keep))
        else:
            self._emit(publication, place, message, keep)
        if running_task() is None:
            self._run(lambda: None)

    def _emit(self, publication: Publication, place: Topic, message: Any, keep: int) -> None:
        """Deliver a node's message: to the world now, to other nodes when the running node waits."""
        place.latest = message
        if keep:
            place.kept[publication] = message
        for listener in place.listeners:
            self._tell(listener, message)
        if place.subscriptions or self._observers:
            self._scheduler.later(lambda: self._deliver(place, message, False, publication))

    def interpose(self, topic: str, channel: Channel) -> None:
        """Add a channel to a topic, after its existing channels."""
        self.topic(topic).channels.append(channel)

    def _pass(self, place: Topic, message: Any, arrive: Callable[[Any], None]) -> None:
        """Pass a message through the channels of a topic; call `arrive` with each result after its delay."""
        now = self._scheduler.time
        arrivals: list[tuple[float, Any]] = [(0.0, message)]
        for channel in place.channels:
            arrivals = [
                (delay + more, changed)
                for delay, one in arrivals
                for more, changed in channel(one, seconds(now) + delay)
            ]
        for delay, one in arrivals:
            if delay > 0.0:
                self._scheduler.at(now + nanoseconds(delay), partial(arrive, one))
            elif running_task() is not None:
                self._scheduler.later(partial(arrive, one))
            else:
                self._run(arrive, one)

    def _tell(self, listener: Listener, message: Any) -> None:
        try:
            listener(message)
        except BaseException as error:
            # an error in the world belongs to the test, not to the publishing node
            self._scheduler.failure = self._scheduler.failure or error

    def advertise(self, publication: Publication, place: Topic) -> None:
        """Add a node's publication."""
        place.publications.append(publication)

    def attach(self, subscription: Subscription, place: Topic, *, wants_kept: bool = True) -> None:
        """Add a node's subscription; it receives latched messages as soon as the node waits."""
        self.subscribed.add(place.name)
        place.subscriptions.append(subscription)
        self._peers_changed(place, subscription, joined=True)
        if wants_kept:
            for publication, message in place.kept.items():
                origin = publication if publication in place.publications else None
                self._scheduler.later(partial(self._hand, place, subscription, message, origin))

    def detach(self, subscription: Subscription, place: Topic) -> None:
        """Remove a node's subscription."""
        if subscription in place.subscriptions:
            place.subscriptions.remove(subscription)
            self._peers_changed(place, subscription, joined=False)

    def _peers_changed(self, place: Topic, subscription: Subscription, *, joined: bool) -> None:
        """Notify a topic's publications of a new or lost subscription."""
        for publication in place.publications:
            changed = getattr(publication, "peers_changed", None)
            if changed is not None:
                self._scheduler.later(partial(changed, subscription, joined=joined))

    def hand(
        self, place: Topic, subscription: Subscription, message: Any, origin: Publication | None = None
    ) -> None:
        """Deliver a copy of a message to one subscription, when the running node waits."""
        message = snapshot(message)
        self._scheduler.later(lambda: self._hand(place, subscription, message, origin))

    def disconnect(self, process: Program) -> None:
        """Remove the publications and subscriptions of a process that has ended."""
        for place in self._topics.values():
            place.publications = [p for p in place.publications if p.process is not process]
            for subscription in [s for s in place.subscriptions if s.process is process]:
                self.detach(subscription, place)

    def _deliver(self, place: Topic, message: Any, spare: bool, origin: Publication | None = None) -> None:
        """Deliver copies to all subscriptions; with `spare`, the last one gets the original."""
        for observer in self._observers:
            observer(place.name, message)
        last = place.subscriptions[-1] if spare and place.subscriptions else None
        for subscription in tuple(place.subscriptions):
            if origin is not None and not _compatible(origin, subscription):
                continue
            if subscription is last and subscription.message_type in (None, type(message)):
                subscription.deliver(message, origin)
            else:
                self._hand(place, subscription, message, origin)

    def _hand(
        self, place: Topic, subscription: Subscription, message: Any, origin: Publication | None
    ) -> None:
        try:
            own = snapshot(message, subscription.message_type)
        except FieldError as error:
            raise RecordingError(
                f"{place.name} carries {type_name(type(message))}, but node {subscription.process.label!r} "
                f"subscribes to it as {type_name(subscription.message_type)}: {error}."
            ) from error
        subscription.deliver(own, origin)


def _compatible(publication: Publication, subscription: Subscription) -> bool:
    """Return whether publication and subscription connect: always in ROS 1, by their QoS in ROS 2."""
    offered, wanted = getattr(publication, "qos_profile", None), getattr(subscription, "qos_profile", None)
    return offered is None or wanted is None or bool(offered.satisfies(wanted))
