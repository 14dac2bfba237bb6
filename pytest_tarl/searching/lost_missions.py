"""If a value passes easy missions but fails where rejected changes lost reward, adjust the value once more.

On easy missions, many values earn enough, so these missions do not show in which direction the value should change. The
missions in which rejected changes lost reward (lost missions) do show the direction: the next value is one with which
the first of these missions earns more.

If a node looks at the time twice a second, all waiting times from 0.51 to 1 s have the same effect. Such values form a
plateau: with each of them, the lost mission is exactly the same. The search then makes further steps until it has left
the plateau.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import sqrt

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.refining import FINEST, OUTWARD, beside
from pytest_tarl.searching.search import Candidate, Mutate, Trials
from pytest_tarl.searching.units import Unit

MOVES = 3  # maximum number of times that the value of a constant is adjusted in this way
STEPS = 2  # maximum number of steps in one direction while the lost mission stays exactly the same


def better_factor(
    unit: Unit, candidate: Candidate, factor: float, tried: Collection[float], mutate: Mutate, trials: Trials
) -> float | None:
    """Return a factor beside `factor` that earns more in a lost mission, else None.

    On a plateau, the factor may also lie beyond a neighbour. `candidate` is the unit with `factor`, and `tried` are the
    factors that were tried. Raise BudgetSpentError.
    """
    seeds = trials.lost_missions()
    if not seeds or factor <= 0.0:
        return None
    mission = _Mission(unit, candidate.guard, mutate, trials, seeds[0])
    lost = trials(candidate, seeds[0])
    for upwards in _directions(factor, tried):
        for at in _steps(factor, tried, upwards):
            outcome = mission(at)
            if outcome is not None and outcome.total > lost.total:
                return at
            if outcome is None or not outcome.acts_like(lost):
                break
    return None


@dataclass(frozen=True)
class _Mission:
    """The lost mission with one unit changed."""

    unit: Unit
    guard: Guard
    mutate: Mutate
    trials: Trials
    seed: int

    def __call__(self, factor: float) -> Outcome | None:
        """Return the outcome with a factor, or None if the change cannot be written. Raise BudgetSpentError."""
        mutations = self.unit.mutations(self.mutate, factor)
        try:
            return self.trials(Candidate(mutations, self.guard), self.seed) if mutations else None
        except RepairError:
            return None


def _directions(factor: float, tried: Collection[float]) -> list[bool]:
    """Return the directions to try (True means upwards), with the one away from 1 first.

    A direction is left out if its nearest tried factor is too close. If no factor was tried in a direction, the nearest
    one counts as `OUTWARD` times larger or smaller.
    """
    below, above = beside(factor, tried, OUTWARD)
    apart = {True: above / factor, False: factor / below}
    return [upwards for upwards in (factor > 1.0, factor <= 1.0) if apart[upwards] >= FINEST]


def _steps(factor: float, tried: Collection[float], upwards: bool) -> Iterator[float]:
    """Yield factors in one direction, each halfway from the last one to the nearest tried factor.

    If the nearest factor is close, the step starts there.
    """
    for _ in range(STEPS):
        nearest = beside(factor, tried, OUTWARD)[upwards]
        while max(nearest / factor, factor / nearest) < FINEST:
            factor, nearest = nearest, beside(nearest, tried, OUTWARD)[upwards]
        factor = sqrt(factor * nearest)
        yield factor
