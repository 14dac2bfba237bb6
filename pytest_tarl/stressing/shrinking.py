"""Shrink failing drifts towards nominal on common seeds, one direction at a time."""

from __future__ import annotations

from pytest_tarl.spaces import Choice, Point, Space
from pytest_tarl.stressing.boundary import COARSE
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.rays import distance

SHRINKS = 4  # halvings of one direction


def shrunk(point: Point, evaluator: Evaluator) -> Point:
    """Return a failing point that halving any single direction does not bring nearer; nominal is tried first.

    Hypothesis would shrink to simple values instead of near ones. Raise BudgetSpentError.
    """
    space, now = evaluator.space, dict(point)
    for name in sorted(now, key=lambda one: -distance(space, {**space.nominal, one: now[one]})):
        usual, step = space.nominal[name], 1.0
        for attempt in range(SHRINKS):
            if now[name] == usual:
                break
            share = 0.0 if attempt == 0 else 1.0 - step
            tried = {**now, name: weighted(space, name, now[name], share)}
            step /= 2
            if evaluator.examine(tried, COARSE).result == "fails":
                now = tried
            elif isinstance(space.extents[name], Choice):
                break
    return now


def weighted(space: Space, name: str, number: float, weight: float) -> float:
    """Return the number at a share of the distance from nominal; an option is either reached or nominal."""
    usual = space.nominal[name]
    if isinstance(space.extents[name], Choice):
        return number if weight > 0.0 else usual
    return usual + (number - usual) * weight
