"""Signals: named numbers that are piecewise constant over virtual time."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.field_paths import dotted
from pytest_tarl.ros_names import objection
from pytest_tarl.sensors import CALLED, as_number

NANOSECONDS = 1_000_000_000
Samples = list[list[Any]]  # [[time in ns, value], …], sorted by time, as rtamt expects; the first time is 0


@dataclass(frozen=True)
class Signal:
    """A number for formulas that is not the value of a sensor.

    If `topic` and `field` are given, the number is read from every message on the topic, including the node's own
    messages. `field` is a dotted path, or a function of the message. Otherwise the test sets the number with
    `tarl.observe(gap=…)`.
    """

    name: str
    topic: str | None = None
    field: str | Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier() or not self.name.isascii():
            raise SettingsError(
                f"Signal name {self.name!r} is not an ASCII identifier: choose one such as 'gap'."
            )
        if (self.topic is None) != (self.field is None):
            raise SettingsError(
                f"Signal {self.name!r} has a topic or a field but not both: give both, or neither and "
                f"report it with tarl.observe({self.name}=…)."
            )
        if isinstance(self.field, str):
            object.__setattr__(self, "field", dotted(self.field))
        for given, what in ((self.topic, "topic"), (None if callable(self.field) else self.field, "field")):
            if given is not None and (not isinstance(given, str) or not given.strip("/.")):
                raise SettingsError(
                    f"Signal {self.name!r}: {what} must be a string such as topic='/odom', "
                    f"field='twist.twist.linear.x', got {given!r}."
                )
        if self.topic is not None and (wrong := objection(self.topic)):
            raise SettingsError(f"Signal {self.name!r}: the name of a topic {wrong}.")


def stored_signal(signal: Signal) -> Signal:
    """Return the signal in a form that can be stored."""
    if not callable(signal.field):
        return signal
    return replace(
        signal, field=f"{getattr(signal.field, '__qualname__', type(signal.field).__name__)}{CALLED}"
    )


class Timeline:
    """The values of all signals during an episode, in virtual ns."""

    def __init__(self, names: Iterable[str]) -> None:
        self._times: dict[str, list[int]] = {name: [] for name in names}
        self._values: dict[str, list[float]] = {name: [] for name in self._times}

    def give(self, name: str, value: Any, time: int) -> None:
        """Set a signal from a given time on. Of several values at the same time, the last counts; NaN is ignored.

        Raise SettingsError if the value is not a number.
        """
        number = signal_value(name, value)
        if math.isnan(number):
            return
        times, values = self._times[name], self._values[name]
        if times and times[-1] == time:
            values[-1] = number
        elif not values or values[-1] != number:
            times.append(time)
            values.append(number)

    def missing(self, names: Iterable[str]) -> str | None:
        """Return the first name without a value, or None."""
        return next((name for name in names if not self._times[name]), None)

    def samples(self, names: Iterable[str]) -> dict[str, Samples]:
        """Return the signals in rtamt's form."""
        return {
            name: [[time if i else 0, value] for i, (time, value) in enumerate(self._columns(name))]
            for name in names
        }

    def at(self, names: Iterable[str], time: int) -> Mapping[str, float]:
        """Return the values of the signals at a given time."""
        found = {}
        for name in names:
            place = bisect_right(self._times[name], time) - 1
            found[name] = self._values[name][max(place, 0)]
        return found

    def instants(self, names: Iterable[str], end: int) -> list[int]:
        """Return the times at which a signal changed, in order, followed by the end."""
        return sorted({time for name in names for time in self._times[name] if time < end} | {0, end})

    def _columns(self, name: str) -> Iterable[tuple[int, float]]:
        return zip(self._times[name], self._values[name], strict=True)


def signal_value(name: str, value: Any) -> float:
    """Return a value as a float, with booleans as 1 and -1. Raise SettingsError if the value is not a number."""
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b":
        return 1.0 if value else -1.0
    number = as_number(value)
    if number is None:
        raise SettingsError(
            f"The signal {name!r} got {value!r}, which is not a number: formulas compare numbers and booleans. "
            "Convert it with a function of the message: Signal(…, field=lambda message: …)."
        )
    return number


def cut(samples: Samples, end: int) -> Samples:
    """Return the samples up to a given time."""
    return samples[: max(1, bisect_left(samples, end + 1, key=_time))]


def _time(sample: list[Any]) -> int:
    return int(sample[0])
