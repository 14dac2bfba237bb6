"""Replay a recorded mission instead of the simulated world; a monitor gives the rewards."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from _pytest.outcomes import Skipped

from pytest_tarl.bags.channels import Recorded
from pytest_tarl.bags.converting import class_named, converted
from pytest_tarl.bags.reading import Bag
from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.marker_arguments import NOTHING_REQUIRED, Requirements
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.messages.field_values import FieldError
from pytest_tarl.ros.messages.snapshot import type_name
from pytest_tarl.ros.names import absolute
from pytest_tarl.sensors import Sensor, reading

if TYPE_CHECKING:
    from pytest_tarl.ros import Ros

Judgement = float | Mapping[str, float]
Monitor = Callable[["Moment"], Judgement]
Judge = Callable[[Mapping[str, Any], Mapping[str, Any]], float]
Close = Callable[[Judgement | None], None]
NO_REWARDS = (
    "A bag holds no rewards: give the marker monitor=, a function of the newest recorded messages, "
    "moment.latest('/odom'), that returns the reward of a step."
)
ALWAYS_THERE = {
    "/clock",
    "/rosout",
    "/parameter_events",
    "/tf",
    "/tf_static",
}  # a bag that lacks these topics needs no note


class MissionReplayed(Skipped):
    """Leave the test body after the replay: the rest of it would run the test's own world."""


class Moment:
    """What a monitor reads at the end of a step: each topic's newest recorded message."""

    def __init__(self, bag: Bag) -> None:
        self.now = 0.0  # seconds since the start of the bag
        self.over = False  # whether this is the last step
        # receives the values of signals that do not come from a topic
        self.observe: Callable[..., None] = _unheard
        self._bag = bag
        self._data: dict[str, bytes] = {}
        self._read: dict[str, Any] = {}
        self._spelled = {absolute(topic): topic for topic in bag.channels}

    def latest(self, topic: str) -> Any | None:
        """Return the newest message on the topic, as recorded; None before the first one."""
        name = self._spelled.get(absolute(topic), topic)
        if name not in self._read and name in self._data:
            self._read[name] = self._bag.decode(name, self._data[name])
        return self._read.get(name)

    def take(self, message: Recorded) -> None:
        """Store a message; `latest` deserialises it when needed."""
        self._data[message.topic] = message.data
        self._read.pop(message.topic, None)


class Replay:
    """The replay of a bag to an episode's nodes.

    The topics of sensors and the topics that nodes subscribe to are replayed, unless a node of the episode publishes on
    them. `notes` are sentences for the user.
    """

    def __init__(
        self,
        bag: Bag,
        sensors: Sequence[Sensor],
        monitor: Monitor | None,
        judge: Judge | None,
        requirements: Requirements = NOTHING_REQUIRED,
    ) -> None:
        self.bag = bag
        self.begun = self.done = False
        self.notes: list[str] = bag.notes
        self._sensed = {absolute(sensor.topic) for sensor in sensors if sensor.topic is not None}
        self._sensed |= {absolute(topic) for topic in requirements.topics}
        self._moment = Moment(bag)
        self._monitor = _chosen(monitor, judge, sensors, requirements)
        self._refused: set[str] = set()

    def begin(self, ros: Ros) -> None:
        """Set the clock to the mission's start, and discard messages of the test's own world."""
        ros.scheduler.time = self.bag.start
        ros.bus.muted = True

    def run(
        self,
        ros: Ros,
        dt: float,
        ready: Callable[[], bool],
        close: Close,
        observe: Callable[..., None],
    ) -> None:
        """Replay the mission in steps of `dt` seconds; close each step once `ready` returns true.

        `close` gets the reward from the monitor, or None if formulas give the rewards. `observe` lets the monitor set
        signals. Raise SettingsError if `dt` is not positive.
        """
        step = nanoseconds(dt)
        if step <= 0:
            raise SettingsError(
                "The test calls tarl.step(0), but replaying a bag needs steps of positive length."
            )
        self.begun = True
        ros.bus.muted, moment, end = False, self._moment, self.bag.start + step
        moment.observe = observe
        for message in self.bag.messages():
            while message.time >= end:
                self._close(ros, end, ready, close)
                end += step
            moment.take(message)
            self._deliver(ros, message)
        moment.over = True
        self._close(ros, end, ready, close)
        self.done = True
        self._conclude(ros)

    def _close(self, ros: Ros, end: int, ready: Callable[[], bool], close: Close) -> None:
        ros.step(seconds(end - ros.scheduler.time))
        self._moment.now = seconds(end - self.bag.start)
        if ready():
            close(self._monitor(self._moment) if self._monitor is not None else None)

    def _deliver(self, ros: Ros, message: Recorded) -> None:
        place, channel = ros.bus.topic(message.topic), self.bag.channels[message.topic]
        wanted = bool(place.subscriptions) or channel.latched or place.name in self._sensed
        if place.publications or not wanted or place.name in self._refused:
            return
        try:
            told = converted(self.bag.decode(message.topic, message.data), self._class(ros, message.topic))
        except (FieldError, KeyError) as problem:
            self._refused.add(place.name)
            self.notes.append(f"{self.bag.path.name}: {place.name} was not replayed: {_sentence(problem)}.")
            return
        if message.time > ros.scheduler.time:
            ros.step(seconds(message.time - ros.scheduler.time))
        ros.bus.publish(place.name, told, latch=channel.latched)

    def _class(self, ros: Ros, topic: str) -> type[Any]:
        """Return the message class that the nodes subscribe with.

        Raise FieldError if the recorded topic has another type.
        """
        name = self.bag.channels[topic].type
        expected = [
            one.message_type for one in ros.bus.topic(topic).subscriptions if one.message_type is not None
        ]
        for one in expected:
            if type_name(one) != name.replace("/msg/", "/"):
                raise FieldError(f"the bag has {name} there, the node subscribes to it as {type_name(one)}")
        found = expected[0] if expected else class_named(name, self.bag.kind)
        if found is None:
            raise FieldError(f"the type {name} is unknown here")
        return found

    def _conclude(self, ros: Ros) -> None:
        """Add notes on subscribed topics without a message, and on nodes that published nothing."""
        held = {absolute(topic) for topic in self.bag.channels}
        own = {place.name for place in ros.bus.topics() if place.publications}
        for topic in sorted(ros.subscribed - held - own - ALWAYS_THERE):
            self.notes.append(
                f"{self.bag.path.name} lacks {topic}, which the node subscribes to: it received no message."
            )
        if not ros.published:
            self.notes.append(f"the node published nothing while {self.bag.path.name} was replayed.")


def _sentence(problem: Exception) -> str:
    return f"{problem.args[0]} is not defined" if isinstance(problem, KeyError) else str(problem)


def _unheard(**values: Any) -> None:
    """Ignore signals outside an episode."""


def _chosen(
    monitor: Monitor | None, judge: Judge | None, sensors: Sequence[Sensor], requirements: Requirements
) -> Monitor | None:
    """Return the monitor of a mission; if formulas give the rewards, it only observes."""
    if requirements.rewarding:
        return _watching(_made(monitor)) if monitor is not None else None
    return _made(monitor) if monitor is not None else _judging(judge, sensors)


def _watching(monitor: Monitor) -> Any:
    """Return a monitor that calls another one and discards its reward."""

    def watch(moment: Moment) -> None:
        monitor(moment)

    return watch


def _made(monitor: Any) -> Monitor:
    """Return the monitor of one mission: a new instance if the marker names a class."""
    made: Monitor = monitor() if isinstance(monitor, type) else monitor
    return made


def _judging(judge: Judge | None, sensors: Sequence[Sensor]) -> Monitor:
    """Return a monitor that calls the marker's `judge` with the sensors before and after each step.

    Raise SettingsError if the marker has no `judge`.
    """
    if judge is None:
        raise SettingsError(NO_REWARDS)
    before: dict[str, Any] = {}

    def monitor(moment: Moment) -> float:
        after = {
            sensor.name: reading(moment.latest(sensor.topic), sensor.field)
            for sensor in sensors
            if sensor.topic is not None and sensor.field is not None
        }
        amount = judge(dict(before or after), dict(after))
        before.update(after)
        return amount

    return monitor
