"""Bisect between a value that is too small and a distant value that restores the reward.

For example, a robot keeps free the 0.3 m from its lidar to its bumper; when it carries a ladder, it needs 1.1 m.
Multiplying by 2.2 is too little. With the next larger step, 6.7 m, the robot stops for anything in the corridor. Values
in between earn more, and they are less likely to do harm in worlds that were not tested.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.smaller import inside
from pytest_tarl.searching.units import Unit

JUMP = 2.7  # minimum ratio of two tried values between which further values are tried
STEPS = 4  # maximum number of values that are tried between two values, each in one episode


class Search(Protocol):
    """The parts of the search that `bisected` uses."""

    gains: Gains

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a factor on a unit. Return the candidate if it was not tried before and is confirmed."""

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        """Try a factor on a mission pair's seed and return whether it reaches the goal (False if tried before)."""


def bisected(
    search: Search, unit: Unit, factor: float, guard: Guard, pair: int
) -> tuple[Unit, float, Candidate] | None:
    """Look for a confirmed value nearer to the old one. Return its unit, factor and candidate, or None.

    `factor` is a confirmed step of the unit. Values are compared by their ratio, even if the step belongs to another
    scale (a chart).
    """
    plain, by = on_values(unit, factor)
    if by is None:
        return None
    low, high = nearest(by, search.gains.of(plain, guard)), by
    for _ in range(STEPS):
        if max(high / low, low / high) < JUMP:
            break
        middle = round(sqrt(low * high), 3)
        if search.reaches(plain, middle, guard, pair):
            high = middle
        elif middle in search.gains.of(plain, guard):
            low = middle
        else:
            break  # the value cannot be written, or it was tried before
    if high == by or not search.reaches(plain, inside(high), guard, pair):
        return None
    candidate = search.holding(plain, high, guard, pair)
    return None if candidate is None else (plain, high, candidate)


def on_values(unit: Unit, factor: float) -> tuple[Unit, float | None]:
    """Return the unit without its chart, and the factor on its value (None for booleans, 0, sign changes)."""
    value = unit.operands[0].value
    if isinstance(value, bool) or value == 0:
        return unit, None
    by: float | None = factor
    if unit.chart is not None:
        by = unit.chart.factor(float(value), factor) if value is not None else None
    return Unit(unit.operands), by if by is not None and by > 0.0 else None


def nearest(factor: float, gains: Mapping[float, float]) -> float:
    """Among the tried factors between the old value (factor 1) and `factor`, return the one nearest to `factor`."""
    inner = [one for one in gains if min(1.0, factor) < one < max(1.0, factor)]
    return (max if factor > 1.0 else min)(inner, default=1.0)
