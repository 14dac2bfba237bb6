"""Move a value on that passes easy missions but loses the missions in which rejected changes lost reward.

On easy missions, many values earn enough, so these missions do not show in which direction the value should change.
The lost missions do: the next value is the one with which the first of them earns more.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.refining import OUTWARD
from pytest_tarl.searching.search import Candidate, Mutate, Trials
from pytest_tarl.searching.units import Unit

MOVES = 3  # maximum number of times that the value of a constant is moved on
CLOSE = 1.1  # no factor is tried if a neighbour is closer than this ratio


def better_factor(
    unit: Unit, candidate: Candidate, factor: float, tried: Iterable[float], mutate: Mutate, trials: Trials
) -> float | None:
    """Return a factor between `factor` and a neighbour that earns more in a lost mission; None if neither does.

    `candidate` is the unit with `factor`, and `tried` are the factors that were tried. Raise BudgetSpentError.
    """
    seeds = trials.lost_missions()
    if not seeds or factor <= 0.0:
        return None
    lost = trials(candidate, seeds[0]).total
    for neighbour in _neighbours(factor, tried):
        between = sqrt(factor * neighbour)
        mutations = unit.mutations(mutate, between)
        try:
            if mutations and trials(Candidate(mutations, candidate.guard), seeds[0]).total > lost:
                return between
        except RepairError:
            continue
    return None


def _neighbours(factor: float, tried: Iterable[float]) -> list[float]:
    """Return the nearest tried factors on both sides, the one farther from 1 first, unless they are close."""
    others = [one for one in tried if one > 0.0]
    above = min((one for one in others if one > factor), default=factor * OUTWARD)
    below = max((one for one in others if one < factor), default=factor / OUTWARD)
    outward = (above, below) if factor > 1.0 else (below, above)
    return [one for one in outward if max(one / factor, factor / one) >= CLOSE]
