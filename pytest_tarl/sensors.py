"""Sensors: inputs of the node. The bins of all sensors form a cell, the index of all learned values."""

from __future__ import annotations

import hashlib
import json
import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from numbers import Real
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.field_paths import dotted, field_value
from pytest_tarl.ros_names import objection
from pytest_tarl.variables import prefixes

Cell = tuple[int, ...]  # for each sensor, the index of a bin
CALLED = "()"  # suffix of `field` in files if it is a function, which is stored by name


@dataclass(frozen=True)
class Sensor:
    """A declared input and its binning.

    With `topic` and `field` (a dotted path, or a function of the message), TARL reads the sensor from the messages that
    the node receives. Without a topic, the test sets it with `tarl.observe(name=value)`. A repair's condition (guard)
    can test a sensor that has a dotted field, or whose `expr` names a variable of the node with its value, such as
    `self.heading`. All other sensors are only used for diagnosis.

    - `low`, `high` (in units of the field) and `bins` make the sensor numeric, with an additional bin at each end for
      values outside.
    - `edges` gives bins of unequal width.
    - `bins` alone means that the edges are learned from recorded episodes, so that all bins have about equally many
      values.
    - An `angle` wraps around; by default, its range is -π to π.
    - `categories` lists the values of a text sensor.
    - Without any of these, values are booleans or small integers, each with its own bin.
    - `tilings` stores the utility in this number of overlapping grids of tiles instead of bins, so that similar values
      share what they learn.
    """

    name: str
    topic: str | None = None
    field: str | Callable[[Any], Any] | None = None
    low: float | None = None
    high: float | None = None
    bins: int | None = None
    categories: tuple[str, ...] = ()
    unit: str = ""
    edges: tuple[float, ...] = ()
    angle: bool = False
    tilings: int = 0
    learned: int = 0  # number of bins requested if the edges were learned, otherwise 0
    expr: str = ""

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
        if isinstance(self.field, str):
            self._set(field=dotted(self.field))
        path = None if callable(self.field) else self.field
        for given, what in ((self.topic, "topic"), (path, "field")):
            if given is not None and (not isinstance(given, str) or not given.strip("/.")):
                raise SettingsError(
                    f"Sensor {self.name!r}: {what} must be a string such as topic='/odom', "
                    "field='pose.pose.position.x', "
                    f"got {given!r}."
                )
        if self.topic is not None and (wrong := objection(self.topic)):
            raise SettingsError(f"Sensor {self.name!r}: the name of a topic {wrong}.")
        if self.expr and not prefixes(self.expr):
            raise SettingsError(
                f"Sensor {self.name!r}: expr must name a variable of the node, such as 'speed', 'self.heading' or "
                f"'self.state[\"yaw\"]', got {self.expr!r}."
            )
        if self.edges:
            self._take_edges()
        if self.angle and self.low is None and self.high is None:
            self._set(low=-math.pi, high=math.pi)
        self._check_range()
        self._check_categories()
        if self.categories and self.bins is not None:
            raise SettingsError(
                f"Sensor {self.name!r} has both a numeric range and categories: remove low, high and bins, or the "
                "categories."
            )
        if self.tilings and (not self.bins or self.tilings < 0):
            raise SettingsError(
                f"Sensor {self.name!r}: tilings must be at least 1 and needs a sensor with bins."
            )

    def _take_edges(self) -> None:
        edges = tuple(math.nan if (end := as_number(one)) is None else end for one in self.edges)
        rising = all(a < b for a, b in pairwise(edges)) and all(map(math.isfinite, edges))
        given = (self.low, self.high, self.bins)
        if (
            (self.angle and len(edges) < 2)
            or not rising
            or given not in ((None,) * 3, (edges[0], edges[-1], len(edges) - 1))
        ):
            raise SettingsError(
                f"Sensor {self.name!r}: edges must be increasing, finite numbers (at least two for an angle), "
                f"without low, high and bins, got {self.edges}."
            )
        self._set(edges=edges, low=edges[0], high=edges[-1], bins=len(edges) - 1)

    def _check_range(self) -> None:
        ends = (self.low, self.high)
        if (self.low is None) != (self.high is None) or (self.bins is None and ends != (None, None)):
            raise SettingsError(
                f"Sensor {self.name!r} needs low, high and bins together; or bins alone, to learn the edges."
            )
        least = 0 if len(self.edges) == 1 else 1  # a single edge only separates the two outer bins
        whole = isinstance(self.bins, int) and not isinstance(self.bins, bool) and self.bins >= least
        low, high = (as_number(end) for end in ends)
        finite = ends == (None, None) or (
            low is not None
            and high is not None
            and -math.inf < low <= high < math.inf
            and (low < high or not least)
        )
        if self.bins is not None and not (whole and finite):
            raise SettingsError(
                f"Sensor {self.name!r}: low must be below high, both finite, and bins a whole number of at least 1, "
                "got "
                f"low={self.low!r}, high={self.high!r}, bins={self.bins!r}."
            )

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check_categories(self) -> None:
        given: Any = self.categories
        if isinstance(given, list):  # a tuple keeps the sensor hashable
            object.__setattr__(self, "categories", tuple(given))
        if not isinstance(given, list | tuple) or not all(isinstance(one, str) for one in given):
            raise SettingsError(
                f"Sensor {self.name!r}: categories lists the strings that it may receive, for example "
                f"categories=('auto', 'manual'), got {given!r}. Booleans and small integers need no categories."
            )
        twice = next((one for one in self.categories if self.categories.count(one) > 1), None)
        if twice is not None:
            raise SettingsError(f"Sensor {self.name!r} has the category {twice!r} twice; name each once.")

    @property
    def numeric(self) -> bool:
        """Return whether the bins are intervals of numbers."""
        return self.bins is not None

    @property
    def to_learn(self) -> bool:
        """Return whether the sensor's bins must still be learned."""
        return self.bins is not None and self.low is None

    @property
    def guardable(self) -> bool:
        """Return whether a repair's condition can read the sensor in the node."""
        return bool(self.expr or self.path)

    @property
    def path(self) -> str:
        """Return the dotted field; empty if there is no field that a node can read."""
        dotted = self.topic is not None and isinstance(self.field, str) and not self.field.endswith(CALLED)
        return str(self.field) if dotted else ""

    @property
    def ends(self) -> tuple[float, ...]:
        """Return the bin edges (bins + 1 of them); empty without bins."""
        if self.edges or self.bins is None or self.low is None or self.high is None:
            return self.edges
        width = (self.high - self.low) / self.bins
        return tuple(self.low + i * width for i in range(self.bins + 1))

    @property
    def resolution(self) -> float:
        """Return the width of the narrowest bin; with a single edge, one unit in its last decimal place."""
        decimals = len(f"{abs(self.edges[0]):.6f}".rstrip("0").partition(".")[2]) if self.edges else 0
        return min((b - a for a, b in pairwise(self.ends)), default=10.0**-decimals)

    def bin(self, value: Any) -> int | None:
        """Return a value's bin: 0 to bins - 1 in the range, -1 below it, `bins` above it, None for NaN.

        Raise SettingsError if the sensor cannot have this value.
        """
        if self.bins is not None:
            number = self._measurement(value)
            return None if math.isnan(number) else self._place(number)
        if self.categories:
            if value not in self.categories:
                raise SettingsError(
                    f"Sensor {self.name!r} got {value!r}, which is not among its categories "
                    f"{', '.join(map(repr, self.categories))}: add it to them."
                )
            return self.categories.index(value)
        whole = as_number(value)
        if whole is None or not whole.is_integer():
            raise SettingsError(
                f"Sensor {self.name!r} got {value!r}: give it low, high and bins for a measurement, "
                "or categories for strings."
            )
        return int(whole)

    def _measurement(self, value: Any) -> float:
        number = as_number(value)
        if number is None:
            raise SettingsError(
                f"Sensor {self.name!r} got {value!r}, which is not a number: correct its field, or give it "
                "categories for "
                "strings."
            )
        return number

    def _place(self, number: float) -> int | None:
        if self.bins is None or self.low is None or self.high is None:
            return 0  # the edges are still unknown; a plain run of the test never learns them
        if self.angle:
            if math.isinf(number):
                return None
            number = self.low + (number - self.low) % (self.high - self.low)
        if number > self.high or (not self.bins and number == self.high):
            return self.bins
        if self.edges:
            index = bisect_right(self.edges, number) - 1
        else:
            index = math.floor(max(-1.0, (number - self.low) / (self.high - self.low) * self.bins))
        return min(index, self.bins - 1)  # the last bin includes its upper end

    def interval(self, first: int, last: int) -> tuple[float, float]:
        """Return the interval of bins `first` to `last`; infinite beyond the outer bins.

        For an angle, `last` may exceed the last bin: the interval then wraps around, and its start exceeds its end.
        """
        if self.bins is None or self.low is None or self.high is None:
            return float(first), float(last)
        ends = self.ends
        if self.angle:
            whole = last - first + 1 >= self.bins
            return (-math.inf, math.inf) if whole else (ends[first % self.bins], ends[last % self.bins + 1])
        return (
            -math.inf if first < 0 else ends[first],
            math.inf if last >= self.bins else ends[last + 1],
        )

    def label(self, index: int) -> str:
        """Return a bin's name as displayed: `4.0-4.4`, `true`, or a category."""
        if self.numeric:
            low, high = self.interval(index, index)
            return f"{low:g}-{high:g}{self.unit and ' ' + self.unit}"
        if self.categories:
            return self.categories[index]
        return str(index)


def as_number(value: Any) -> float | None:
    """Return a real number or numpy scalar as a float; None for anything else."""
    if not isinstance(value, Real) and getattr(value, "ndim", None) != 0:
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
    except (TypeError, ValueError):
        return None


def reading(message: Any, field: str | Callable[[Any], Any]) -> Any:
    """Return the value that a sensor reads from a message."""
    return field(message) if callable(field) else field_value(message, field)


def stored(sensor: Sensor) -> Sensor:
    """Return the sensor in serialisable form: a function becomes its name, followed by CALLED."""
    if not callable(sensor.field):
        return sensor
    return replace(
        sensor, field=f"{getattr(sensor.field, '__qualname__', type(sensor.field).__name__)}{CALLED}"
    )


def binning_digest(sensors: Iterable[Sensor]) -> str:
    """Return a short hash of the sensors' inputs and bins. If hashes are equal, cells can be compared."""
    text = json.dumps([asdict(stored(sensor)) for sensor in sensors], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def declared(sensor: Sensor) -> Sensor:
    """Return the sensor as declared in the marker, without learned edges."""
    plain = stored(sensor)
    return (
        replace(plain, edges=(), low=None, high=None, bins=plain.learned, learned=0)
        if plain.learned
        else plain
    )


def with_edges(sensors: Iterable[Sensor], learned: Mapping[str, tuple[float, ...]]) -> tuple[Sensor, ...]:
    """Return the sensors with the learned edges; `learned` maps sensor names to edges."""
    return tuple(
        replace(sensor, bins=None, edges=learned[sensor.name], learned=sensor.bins or 0)
        if sensor.to_learn and sensor.name in learned
        else sensor
        for sensor in sensors
    )
