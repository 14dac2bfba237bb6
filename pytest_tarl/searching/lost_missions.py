"""If a value passes easy missions but fails where rejected changes lost reward, move the value further.

On easy missions, many values earn enough, so these missions do not show in which direction the value should change. The
missions in which rejected changes lost reward (lost missions) do show the direction: the next value is one with which
the first of these missions earns more.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.refining import FINEST, OUTWARD
from pytest_tarl.searching.search import Candidate, Mutate, Trials
from pytest_tarl.searching.units import Unit

MOVES = 3  # maximum number of times that the value of a constant is moved further


def better_factor(
    unit: Unit, candidate: Candidate, factor: float, tried: Iterable[float], mutate: Mutate, trials: Trials
) -> float | None:
    """Return a factor between `factor` and one of its neighbours if it earns more in a lost mission, else None.

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
    """Return the nearest tried factors on both sides. The one farther from 1 comes first; close ones are left out."""
    others = [one for one in tried if one > 0.0]
    above = min((one for one in others if one > factor), default=factor * OUTWARD)
    below = max((one for one in others if one < factor), default=factor / OUTWARD)
    outward = (above, below) if factor > 1.0 else (below, above)
    return [one for one in outward if max(one / factor, factor / one) >= FINEST]
