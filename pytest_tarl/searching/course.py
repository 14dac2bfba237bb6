"""Compare the courses of two missions. The course of a mission is its cumulative reward over time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate


def deviation(rewards: Sequence[float], designed: Sequence[float]) -> float:
    """Return the mean distance of two courses, divided by the largest absolute value of the designed course.

    `rewards` and `designed` are the rewards of each step. After the shorter mission ends, its total stays constant.
    """
    steps = max(len(rewards), len(designed))
    mine, its = _cumulative(rewards, steps), _cumulative(designed, steps)
    largest = max((abs(one) for one in its), default=0.0)
    if not largest:
        return 0.0
    return sum(abs(one - other) for one, other in zip(mine, its, strict=True)) / steps / largest


def _cumulative(rewards: Sequence[float], steps: int) -> list[float]:
    found = list(accumulate(rewards)) or [0.0]
    return [*found, *[found[-1]] * (steps - len(found))]
