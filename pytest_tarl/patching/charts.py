"""Charts: the scales on which a search moves a constant other than by factors on its value.

For a share such as 0.95, the search scales the distance from 1: if the share should be 0.994, this distance is wrong by
a factor of 8. An offset such as -0.012 is moved in steps of the size of the numbers that it is added to. On both
scales, the steps are the same as with factors.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import copysign


class Scale(Enum):
    """A kind of scale: `REST` scales a share's distance from 1, `SHIFT` adds to an offset."""

    REST = "rest"
    SHIFT = "shift"


@dataclass(frozen=True, slots=True)
class Chart:
    """A scale and, for `SHIFT`, the usual size of the values that the constant is added to."""

    scale: Scale
    size: float = 1.0

    def factor(self, value: float, step: float) -> float | None:
        """Return the factor on the constant's value that corresponds to a step, or None if there is none.

        A step of 1 changes nothing. A step of 5 divides a share's distance from 1 by 5, and adds four times `size` to
        an offset. A step of 0.2 is the inverse of a step of 5.
        """
        if step <= 0.0:
            return None
        if self.scale is Scale.REST:
            return (1.0 - (1.0 - value) / step) / value if value else None
        by = self.size * distance(step)
        return 1.0 + by / value if value else step_to(by)

    def step(self, value: float, new: float) -> float | None:
        """Return the step from `value` to `new`, or None if there is none."""
        if self.scale is Scale.REST:
            return (1.0 - value) / (1.0 - new) if new < 1.0 else None
        return step_to((new - value) / self.size)


def distance(step: float) -> float:
    """Return the change made by a step in multiples of the chart's size: 4 for a step of 5, -4 for 0.2."""
    return step - 1.0 if step >= 1.0 else 1.0 - 1.0 / step


def step_to(distance: float) -> float:
    """Return the step that makes this change (the inverse of `distance`)."""
    return 1.0 + distance if distance >= 0.0 else 1.0 / (1.0 - distance)


def offset(size: float) -> Chart:
    """Return the chart of a constant that is added to values of this size."""
    return Chart(Scale.SHIFT, float(f"{copysign(size, 1.0):.2g}"))


SHARE = Chart(Scale.REST)
