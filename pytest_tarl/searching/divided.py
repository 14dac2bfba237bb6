"""Recognise a constant that needs different values in different missions.

One value reaches the goal only in some missions, and another value reaches it in the missions where the first value
fails. Then no single value restores the reward, and refining either value wastes episodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import sqrt

from pytest_tarl.model import Guard
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit

# if a constant follows a power of a sensor or a variable, the exponent is multiplied by these factors
POWERS = (1.0, 1.3, 0.77)


def divided(
    unit: Unit,
    guard: Guard,
    factor: float,
    tried: Mapping[float, float],
    mutate: Mutate,
    trials: Trials,
    goal: Goal,
) -> float | None:
    """Return a factor between two factors that each reach the goal where the other factor fails, or None.

    One of the two factors is `factor`; the other is a factor in `tried`, which holds the factors that ran so far. Both
    must change the constant in the same direction. If both reached the goal somewhere and one of them failed elsewhere,
    each runs on the seeds on which the other reached the goal. Raise BudgetSpentError and RepairError.
    """
    mine = Candidate(unit.mutations(mutate, factor), guard)
    here = _reached(mine, trials, goal)
    failed = _failed(mine, trials, goal)
    for other in tried if here else ():
        if other <= 0.0 or other in (1.0, factor) or (other > 1.0) != (factor > 1.0):
            continue
        its = Candidate(unit.mutations(mutate, other), guard)
        there = [seed for seed in _reached(its, trials, goal) if seed not in here]
        if not there or not (failed or _failed(its, trials, goal)):
            continue  # both candidates may reach the goal on all seeds
        if goal.reached(trials(mine, there[0]), there[0]):
            continue
        if not any(goal.reached(trials(its, seed), seed) for seed in here[:1]):
            return sqrt(factor * other)
    return None


def stronger_and_weaker(candidate: Candidate) -> Iterator[Candidate]:
    """Yield a candidate whose constant follows a power of a quantity, then variants with other exponents."""
    for power in POWERS:
        yield replace(candidate, mutations=tuple(replace(one, value=power) for one in candidate.mutations))


def _reached(candidate: Candidate, trials: Trials, goal: Goal) -> list[int]:
    """Return the seeds on which a candidate ran and reached the goal."""
    return [
        pair.seed
        for pair in goal.pairs
        for outcome in trials.ran(candidate, [pair])
        if goal.reached(outcome, pair.seed)
    ]


def _failed(candidate: Candidate, trials: Trials, goal: Goal) -> bool:
    """Return whether a candidate ran on a seed on which it did not reach the goal."""
    return len(_reached(candidate, trials, goal)) < len(trials.ran(candidate, goal.pairs))
