"""Spaces of drifts: the directions in which a world can change, each with a nominal value.

A point of a space has one number per direction, by name: the value of a range, or the index of an option.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, Protocol

from pytest_tarl.errors import SettingsError
from pytest_tarl.finite_numbers import finite_number
from pytest_tarl.schedules import Profile, Schedule

if TYPE_CHECKING:
    import numpy as np

Point = Mapping[str, float]
DIRECTIONS = "Drift.range(…, nominal=…), Drift.choice(…), or a fault such as faults.bias(…)"


@dataclass(frozen=True, slots=True)
class Span:
    """A closed range of numbers, from which each episode draws uniformly; in a space, it has a nominal number.

    With a profile, the drawn number is the size of a drift over time.
    """

    low: float
    high: float
    nominal: float | None = None
    profile: Profile | None = None


@dataclass(frozen=True, slots=True)
class Choice:
    """Options, one of which each episode draws; `usual` is the index of the nominal one."""

    options: tuple[Any, ...]
    usual: int = 0


class Fault(Protocol):
    """A fault of the nodes' messages or processes.

    `extent` has the possible sizes; at the nominal size, there is no fault.
    """

    @property
    def extent(self) -> Span | Choice:
        """Return the possible sizes."""

    def install(self, ros: Any, name: str, size: float, draws: np.random.Generator) -> None:
        """Install the fault in an episode's ROS. `name` is the direction's name, for messages."""

    def check(self, ros: Any, name: str) -> None:
        """Raise SettingsError after an episode without the fault's topic or node."""


@dataclass(frozen=True, slots=True)
class Space:
    """All combinations of the values of directions and faults.

    `directions` change the test's world, `faults` the nodes.
    """

    directions: Mapping[str, Span | Choice]
    faults: Mapping[str, Fault]

    @property
    def extents(self) -> Mapping[str, Span | Choice]:
        """Return the possible values of all directions, in the order of their declaration."""
        return {**self.directions, **{name: fault.extent for name, fault in self.faults.items()}}

    @property
    def nominal(self) -> Point:
        """Return the nominal point."""
        return {name: nominal(extent) for name, extent in self.extents.items()}

    def world(self, point: Point) -> dict[str, Any]:
        """Return the value of `tarl_drift` at a point: a dictionary by direction."""
        return {name: world_value(extent, point[name]) for name, extent in self.directions.items()}

    def active(self, point: Point) -> Mapping[str, tuple[Fault, float]]:
        """Return the faults that are not nominal at a point, with their sizes."""
        return {
            name: (fault, point[name])
            for name, fault in self.faults.items()
            if point[name] != nominal(fault.extent)
        }


def nominal(extent: Span | Choice) -> float:
    """Return the nominal number of a direction; for a choice, the index of the nominal option."""
    if isinstance(extent, Choice):
        return float(extent.usual)
    return extent.low if extent.nominal is None else extent.nominal


def value_of(extent: Span | Choice, number: float) -> Any:
    """Return the value for a point's number in one direction: an option, or the number itself."""
    return extent.options[int(number)] if isinstance(extent, Choice) else number


def world_value(extent: Span | Choice, number: float) -> Any:
    """Return the value in `tarl_drift` for a point's number in one direction; drifts over time become Schedules."""
    if isinstance(extent, Span) and extent.profile is not None:
        return Schedule(nominal(extent), number, extent.profile)
    return value_of(extent, number)


def span(what: str, low: Any, high: Any, nominal: Any, profile: Profile | None = None) -> Span:
    """Return a checked range; `what` names it in messages. Raise SettingsError if it is invalid."""
    least, most = finite_number(low), finite_number(high)
    if least is None or most is None or not least < most:
        raise SettingsError(f"{what}: give two finite numbers, the smaller one first.")
    if not isfinite(most - least):
        raise SettingsError(
            f"{what}: the range from {least:g} to {most:g} is too wide for a number: narrow it."
        )
    if nominal is None:
        return Span(least, most)
    usual = finite_number(nominal)
    if usual is None or not least <= usual <= most:
        raise SettingsError(
            f"{what}: the nominal value must be a number from {least:g} to {most:g}, got {nominal!r}."
        )
    return Span(least, most, usual, profile)


def choice(options: tuple[Any, ...], usual: Any) -> Choice:
    """Return checked options, of which the first that equals `usual` is nominal. Raise SettingsError if invalid."""
    if len(options) < 2:
        raise SettingsError(f"Drift.choice needs at least two options, got {len(options)}.")
    found = [index for index, option in enumerate(options) if option is usual or _equal(option, usual)]
    if not found:
        raise SettingsError(f"Drift.choice: the nominal value {usual!r} is not one of {options!r}.")
    return Choice(options, found[0])


def _equal(option: Any, usual: Any) -> bool:
    """Return whether two options are equal; False if they cannot be compared or, like arrays, have no truth value."""
    try:
        return bool(option == usual)
    except (ValueError, TypeError):
        return False


def space(parts: Mapping[str, Any]) -> Space:
    """Return a space of checked ranges, choices and faults. Raise SettingsError for other directions."""
    if not parts:
        raise SettingsError(f"Drift.space() has no direction: name at least one, each {DIRECTIONS}.")
    directions: dict[str, Span | Choice] = {}
    faults: dict[str, Fault] = {}
    for name, part in parts.items():
        if isinstance(part, Span) and part.nominal is None:
            raise SettingsError(
                f"Drift.space: {name!r} has no nominal value, at which recordings are made: write "
                f"Drift.range({part.low:g}, {part.high:g}, nominal=…)."
            )
        if isinstance(part, Span | Choice):
            directions[name] = part
        elif hasattr(part, "install") and hasattr(part, "extent"):
            faults[name] = part
        else:
            raise SettingsError(f"Drift.space: {name!r} must be {DIRECTIONS}, got {part!r}.")
    return Space(directions, faults)
