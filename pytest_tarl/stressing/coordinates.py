"""Drifts as vectors: for each range, the difference from nominal in units of the declared range.

Choices have no coordinate; their options come from a base point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.spaces import Choice, Point, Space, Span, nominal
from pytest_tarl.stressing.rays import distance

Vector = NDArray[np.float64]
ROUNDING = 1e-12  # maximum difference from nominal that counts as nominal


@dataclass(frozen=True)
class Coordinates:
    """The coordinates of all drifts with the same options as `base`; the zero vector is nominal."""

    space: Space
    base: Point

    @cached_property
    def spans(self) -> dict[str, Span]:
        """Return the ranges by direction, in the order of the coordinates."""
        return {name: one for name, one in self.space.extents.items() if isinstance(one, Span)}

    @cached_property
    def low(self) -> Vector:
        """Return the smallest value of each coordinate, at most 0; shape (ranges,)."""
        return np.array([(one.low - nominal(one)) / (one.high - one.low) for one in self.spans.values()])

    @cached_property
    def high(self) -> Vector:
        """Return the largest value of each coordinate, at least 0; shape (ranges,)."""
        return np.array([(one.high - nominal(one)) / (one.high - one.low) for one in self.spans.values()])

    @cached_property
    def options(self) -> int:
        """Return the number of options of the base that are not nominal."""
        return sum(
            isinstance(extent, Choice) and self.base[name] != nominal(extent)
            for name, extent in self.space.extents.items()
        )

    def vector(self, point: Point) -> Vector:
        """Return the coordinates of a point."""
        return np.array(
            [(point[name] - nominal(one)) / (one.high - one.low) for name, one in self.spans.items()]
        )

    def point(self, vector: Vector) -> Point:
        """Return the point at a vector; coordinates outside the ranges are clipped."""
        found = dict(self.base)
        for (name, one), number in zip(self.spans.items(), np.clip(vector, self.low, self.high), strict=True):
            usual = nominal(one)
            value = usual + float(number) * (one.high - one.low)
            found[name] = usual if abs(number) < ROUNDING else min(max(value, one.low), one.high)
        return found

    def covers(self, point: Point) -> bool:
        """Return whether a point has the same options as the base."""
        return all(point[name] == self.base[name] for name in self.base if name not in self.spans)

    def within(self, vector: Vector, limit: float) -> Vector | None:
        """Return the vector, shortened so that its point is at most `limit` from nominal.

        Return None if the options alone are farther than that.
        """
        room = limit**2 - self.options
        length = distance(self.space, self.point(vector)) ** 2 - self.options
        if room <= 0.0:
            return None
        vector = np.clip(vector, self.low, self.high)
        return vector if length <= room else vector * np.sqrt(room / length)
