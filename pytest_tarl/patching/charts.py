"""Scales on which a constant moves, beside factors on its value.

A share of 0.95 that should be 0.994 is wrong by a factor of 8 in its distance from 1. An offset of -0.012 that should
be 0.055 is wrong by as much as the angles that it is added to. On either scale, a search makes the same steps as for a
gain.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import copysign


class Scale(Enum):
    """`REST` moves the distance of a share from 1, `SHIFT` adds to an offset."""

    REST = "rest"
    SHIFT = "shift"


@dataclass(frozen=True, slots=True)
class Chart:
    """A scale with the size of its steps: for `SHIFT`, that of the values to which the constant is added."""

    scale: Scale
    size: float = 1.0

    def factor(self, value: float, step: float) -> float | None:
        """Return the factor on a constant that makes one step, as `mutations` takes it; None if there is none.

        A step of 1 changes nothing. Steps above and below 1 are symmetric on a log scale: 5 moves a share to a fifth of
        its distance from 1, and an offset by four times `size`; 0.2 the other way.
        """
        if step <= 0.0:
            return None
        if self.scale is Scale.REST:
            return (1.0 - (1.0 - value) / step) / value if value else None
        by = self.size * distance(step)
        return 1.0 + by / value if value else step_to(by)

    def step(self, value: float, new: float) -> float | None:
        """Return the step that moves a constant from `value` to `new`; None if there is none."""
        if self.scale is Scale.REST:
            return (1.0 - value) / (1.0 - new) if new < 1.0 else None
        return step_to((new - value) / self.size)


def distance(step: float) -> float:
    """Return how far a step from zero goes, in units of its size: 5 goes by 4, 0.2 by -4."""
    return step - 1.0 if step >= 1.0 else 1.0 - 1.0 / step


def step_to(distance: float) -> float:
    """Return the step from zero that goes this far; the inverse of `distance`."""
    return 1.0 + distance if distance >= 0.0 else 1.0 / (1.0 - distance)


def offset(size: float) -> Chart:
    """Return the chart of a constant that is added to values of this size."""
    return Chart(Scale.SHIFT, float(f"{copysign(size, 1.0):.2g}"))


SHARE = Chart(Scale.REST)
