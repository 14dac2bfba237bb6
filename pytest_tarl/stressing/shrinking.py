"""Shrink failing drifts towards nominal on the common seeds, one direction at a time."""

from __future__ import annotations

from pytest_tarl.spaces import Choice, Point, Space
from pytest_tarl.stressing.boundary import COARSE
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.rays import distance

SHRINKS = 4  # maximum number of attempts per direction


def shrunk(point: Point, evaluator: Evaluator) -> Point:
    """Move single directions of a failing point towards nominal as long as it still fails.

    For each direction, the nominal value is tried first, then smaller and smaller steps. Hypothesis's own shrinking
    would prefer simple values, which need not be near nominal. Raise BudgetSpentError.
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
    """Return the number at share `weight` of the way from nominal to `number`.

    An option changes at every weight above 0.
    """
    usual = space.nominal[name]
    if isinstance(space.extents[name], Choice):
        return number if weight > 0.0 else usual
    return usual + (number - usual) * weight
