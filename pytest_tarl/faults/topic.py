"""The common base of topic faults: a channel that the topic's messages pass through."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.faults.message_numbers import altered, no_such_field
from pytest_tarl.field_paths import dotted
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.ros_names import objection
from pytest_tarl.spaces import Choice, Span, span

if TYPE_CHECKING:
    import numpy as np

Arrivals = Iterable[tuple[float, Any]]  # (delay (s), message)
Channel = Callable[[Any, float], Arrivals]  # (message, virtual time (s)) → arrivals of the message, in order
OFF_ON = Choice((False, True))


@dataclass(frozen=True)
class TopicFault:
    """A fault of all messages on one topic.

    `begin` creates the channel for an episode from the fault's size and random numbers.
    """

    kind: str
    topic: str
    extent: Span | Choice
    begin: Callable[[float, np.random.Generator], Channel]
    field: str = ""

    def install(self, ros: Any, name: str, size: float, draws: np.random.Generator) -> None:
        """Pass the topic's messages through the fault. Raise SettingsError if a message lacks the field."""
        channel = self.begin(size, draws)

        def passed(message: Any, now: float) -> Arrivals:
            try:
                return channel(message, now)
            except (AttributeError, IndexError, KeyError, TypeError) as problem:
                raise no_such_field(name, self.kind, self.topic, self.field, message) from problem

        ros.bus.interpose(self.topic, passed)

    def check(self, ros: Any, name: str) -> None:
        """Raise SettingsError if the topic had no message in the episode."""
        carried = sorted(place.name for place in ros.bus.topics() if place.carried)
        if ros.bus.topic(self.topic).carried:
            return
        raise SettingsError(
            f"faults.{self.kind} of {name!r}: no message was published on {self.topic}; the topics with messages are "
            f"{', '.join(carried) or 'none'}. Correct the topic in the marker."
        )


def of_field(
    kind: str,
    topic: str,
    field: str,
    extent: Span | Choice,
    change: Callable[[float, np.random.Generator], Callable[[float], float]],
) -> TopicFault:
    """Return a fault that changes each number of a field on its own. Raise SettingsError for invalid arguments."""
    require_text(kind, "topic", topic)
    require_text(kind, "field", field)
    field = dotted(field)

    def begin(size: float, draws: np.random.Generator) -> Channel:
        changed = change(size, draws)
        return lambda message, _: [(0.0, altered(message, field, changed))]

    return TopicFault(kind, topic, extent, begin, field)


def of_topic(
    kind: str, topic: str, extent: Span | Choice, begin: Callable[[float, np.random.Generator], Channel]
) -> TopicFault:
    """Return a fault that changes whole messages. Raise SettingsError for an invalid topic."""
    require_text(kind, "topic", topic)
    return TopicFault(kind, topic, extent, begin)


def sizes(kind: str, low: Any, high: Any, none: float) -> Span:
    """Return the range of a fault's sizes.

    Raise SettingsError if the range lacks `none`, the size of no fault.
    """
    found = span(f"faults.{kind}(…, {low!r}, {high!r})", low, high, None)
    if not found.low <= none <= found.high:
        raise SettingsError(
            f"faults.{kind}(…, {low!r}, {high!r}): the sizes must include {none:g}, the nominal size, which "
            "means no fault."
        )
    return Span(found.low, found.high, none)


# maximum duration in a fault (s): about 30 years, which fits into 64 bits as nanoseconds
LONGEST = 1e9


def moment(value: Any) -> float | None:
    """Return a time in s that the clock can represent, or None for any other value."""
    found = finite_number(value)
    return found if found is not None and 0.0 <= found <= LONGEST else None


def up_to(kind: str, most: Any, limit: float | None = None) -> Span:
    """Return the sizes from 0 (no fault) to `most`.

    Raise SettingsError unless `most` is positive and at most `limit`.
    """
    largest = finite_number(most)
    if largest is None or largest <= 0.0 or (limit is not None and largest > limit):
        upper = "" if limit is None else f", at most {limit:g}"
        raise SettingsError(f"faults.{kind}: the largest size must be a number above 0{upper}, got {most!r}.")
    return Span(0.0, largest, 0.0)


def require_text(kind: str, what: str, value: Any) -> None:
    """Raise SettingsError unless an argument is a non-empty string; `what` is "topic" or "field"."""
    if not isinstance(value, str) or not value:
        raise SettingsError(
            f'faults.{kind}: give the {what} as text, for example "{"/odom" if what == "topic" else "data"}", got '
            f"{value!r}."
        )
    if what == "topic" and (wrong := objection(value)):
        raise SettingsError(f"faults.{kind}: the name of a topic {wrong}.")
