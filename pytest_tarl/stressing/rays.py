"""Straight lines through a space, from the nominal point to a farthest one.

A space declares directions, which are ranges of numbers or choices of options. A point has one number per direction;
for a choice, this is the index of the option.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

from pytest_tarl.spaces import Choice, Point, Space, Span, nominal

SWEEP = (0.25, 0.5, 0.75, 1.0)  # positions t of the coarse sweep


@dataclass(frozen=True)
class Ray:
    """The points (1 - t) · nominal + t · farthest for t from 0 to 1; `names` are the directions that change."""

    space: Space
    names: tuple[str, ...]
    farthest: Point
    extra: tuple[float, ...] = ()  # positions t that the sweep visits in addition to the usual ones

    @property
    def continuous(self) -> bool:
        """Return whether every t gives a different point; False for a ray to an option."""
        return not any(isinstance(self.space.extents[name], Choice) for name in self.names)

    @property
    def places(self) -> tuple[float, ...]:
        """Return the positions t of the coarse sweep, starting at the far end."""
        places = {*SWEEP, *self.extra} if self.continuous else {1.0}
        return tuple(sorted(places, reverse=True))

    @property
    def length(self) -> float:
        """Return the distance of the farthest point from nominal."""
        return distance(self.space, self.farthest)

    def point(self, t: float) -> Point:
        """Return the point at t; a choice has its farthest option at every t above 0."""
        start = self.space.nominal
        return {
            name: _between(extent, start[name], self.farthest[name], t)
            for name, extent in self.space.extents.items()
        }

    def value(self, t: float) -> float:
        """Return the value of the ray's first direction at t."""
        return self.point(t)[self.names[0]]


def rays(space: Space, must_hold: Mapping[str, Sequence[Any]]) -> list[Ray]:
    """Return the rays along single directions: to both ends of each range, and to each option."""
    found = []
    for name, extent in space.extents.items():
        usual = nominal(extent)
        ends = range(len(extent.options)) if isinstance(extent, Choice) else (extent.low, extent.high)
        for end in ends:
            if end != usual:
                along = [(one - usual) / (end - usual) for one in _limits(extent, must_hold.get(name, ()))]
                extra = tuple(t for t in along if 0.0 < t < 1.0)
                found.append(Ray(space, (name,), {**space.nominal, name: float(end)}, extra))
    return found


def joined(parts: Sequence[tuple[Ray, float]]) -> Ray:
    """Return the ray to the point that combines the values of several rays, each at its given position."""
    space = parts[0][0].space
    farthest = dict(space.nominal)
    for ray, t in parts:
        farthest[ray.names[0]] = ray.value(t)
    return Ray(space, tuple(ray.names[0] for ray, _ in parts), farthest)


def distance(space: Space, point: Point) -> float:
    """Return the Euclidean distance of a point from nominal, in units of the declared ranges.

    An option that is not nominal counts as 1.
    """
    return sqrt(sum(offset(extent, point[name]) ** 2 for name, extent in space.extents.items()))


def offset(extent: Span | Choice, number: float) -> float:
    """Return a number's distance from nominal in units of the range; 1 for an option that is not nominal."""
    away = abs(number - nominal(extent))
    return float(away > 0) if isinstance(extent, Choice) else away / (extent.high - extent.low)


def _between(extent: Span | Choice, start: float, end: float, t: float) -> float:
    if isinstance(extent, Choice):
        return end if t > 0.0 else start
    return end if t == 1.0 else start + (end - start) * t


def _limits(extent: Span | Choice, must_hold: Sequence[Any]) -> Sequence[float]:
    return [float(one) for one in must_hold] if isinstance(extent, Span) else ()
