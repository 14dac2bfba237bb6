"""Sensors: what the node was told, binned into the cell that everything is learned by."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Any

from pytest_tarl.errors import SettingsError

Cell = tuple[int, ...]  # one bin per sensor


@dataclass(frozen=True)
class Sensor:
    """A declared input and how it is binned.

    With `topic` and `field` (dotted) it is read from the messages delivered to the node and can appear
    in a guard; without them the test gives its value through `tarl.observe(name=value)` and it is
    diagnostic only. `low`, `high` (units of the field) and `bins` make it numeric, with one more bin at
    either end for values outside. `categories` lists the values of a text sensor. With neither it takes
    booleans and small integers as they are.
    """

    name: str
    topic: str | None = None
    field: str | None = None
    low: float | None = None
    high: float | None = None
    bins: int | None = None
    categories: tuple[str, ...] = ()
    unit: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise SettingsError(
                f"Sensor name {self.name!r} is not a Python identifier: choose one such as 'x'."
            )
        if (self.topic is None) != (self.field is None):
            raise SettingsError(
                f"Sensor {self.name!r} has a topic or a field but not both: give both, or neither "
                f"and report it with tarl.observe({self.name}=…)."
            )
        for given, what in ((self.topic, "topic"), (self.field, "field")):
            if given is not None and (not isinstance(given, str) or not given.strip("/.")):
                raise SettingsError(
                    f"Sensor {self.name!r}: {what} must be a text such as topic='/odom', field='pose.pose.position.x', "
                    f"got {given!r}."
                )
        self._check_bins()
        self._check_categories()

    def _check_bins(self) -> None:
        bounds = (self.low, self.high, self.bins)
        if all(bound is None for bound in bounds):
            return
        if self.low is None or self.high is None or self.bins is None:
            raise SettingsError(f"Sensor {self.name!r} needs low, high and bins together, or none of them.")
        finite = all(math.isfinite(math.nan if end is None else end) for end in map(as_number, bounds[:2]))
        whole = isinstance(self.bins, int) and not isinstance(self.bins, bool)
        if not finite or not self.low < self.high or not whole or self.bins < 1:
            raise SettingsError(
                f"Sensor {self.name!r}: low must be below high, both finite, and bins at least 1 and whole, got "
                f"low={self.low!r}, high={self.high!r}, bins={self.bins!r}."
            )
        if self.categories:
            raise SettingsError(
                f"Sensor {self.name!r} is either numeric (low, high, bins) or has categories."
            )

    def _check_categories(self) -> None:
        given: Any = self.categories
        if isinstance(given, list):  # else the sensor could not be hashed
            object.__setattr__(self, "categories", tuple(given))
        elif not isinstance(given, tuple):
            raise SettingsError(
                f"Sensor {self.name!r}: categories lists the texts that it may get, for instance "
                f"categories=('auto', 'manual'), got {given!r}."
            )
        twice = next((one for one in self.categories if self.categories.count(one) > 1), None)
        if twice is not None:
            raise SettingsError(f"Sensor {self.name!r} has the category {twice!r} twice; name each once.")

    @property
    def numeric(self) -> bool:
        """Tell whether values are binned by intervals."""
        return self.bins is not None

    @property
    def guardable(self) -> bool:
        """Tell whether a node can read it, so that a guard may test it."""
        return self.topic is not None

    def bin(self, value: Any) -> int | None:
        """Return the bin of `value`: 0 to bins-1, -1 and `bins` outside; None for NaN, which tells nothing."""
        if self.bins is not None and self.low is not None and self.high is not None:
            number = self._measurement(value)
            if math.isnan(number):
                return None
            place = (number - self.low) / (self.high - self.low) * self.bins
            index = math.floor(max(-1.0, min(float(self.bins), place)))
            return (
                index if number > self.high else min(index, self.bins - 1)
            )  # the upper end is of the last bin
        if self.categories:
            if value not in self.categories:
                raise SettingsError(
                    f"Sensor {self.name!r} got {value!r}, which is not among its categories "
                    f"{', '.join(map(repr, self.categories))}: add it there."
                )
            return self.categories.index(value)
        whole = as_number(value)
        if whole is None or not whole.is_integer():
            raise SettingsError(
                f"Sensor {self.name!r} got {value!r}: give it low, high and bins for a measurement, "
                "or categories for texts."
            )
        return int(whole)

    def _measurement(self, value: Any) -> float:
        number = as_number(value)
        if number is None:
            raise SettingsError(
                f"Sensor {self.name!r} got {value!r}, which is no number: mend its field, or give it categories for "
                "texts."
            )
        return number

    def interval(self, first: int, last: int) -> tuple[float, float]:
        """Return the values that bins `first` to `last` cover; infinite beyond the outer bins."""
        if self.bins is None or self.low is None or self.high is None:
            return float(first), float(last)
        width = (self.high - self.low) / self.bins
        low = -math.inf if first < 0 else self.low + first * width
        high = math.inf if last >= self.bins else self.low + (last + 1) * width
        return low, high

    def label(self, index: int) -> str:
        """Name a bin for people: `4.0-4.4`, `true`, a category."""
        if self.numeric:
            low, high = self.interval(index, index)
            return f"{low:g}-{high:g}{self.unit and ' ' + self.unit}"
        if self.categories:
            return self.categories[index]
        return str(index)


def as_number(value: Any) -> float | None:
    """Return a real number, or a single one of numpy, as a float; None for anything else."""
    if not isinstance(value, Real) and getattr(value, "ndim", None) != 0:
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
    except (TypeError, ValueError):
        return None


def field_value(message: Any, field: str) -> Any:
    """Follow a dotted field; a number indexes a sequence (`ranges.0`). Raises AttributeError or IndexError."""
    for part in field.split("."):
        if isinstance(message, Mapping):
            message = message[part]
        elif part.lstrip("-").isdigit() and hasattr(message, "__getitem__"):
            message = message[int(part)]
        else:
            message = getattr(message, part)
    return message
