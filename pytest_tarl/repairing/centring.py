"""A better value for a candidate that holds and loses much of what it may: a test of it would not come to an end.

What loses more than half of the margin is hard to tell from what loses all of it. A value nearer to the middle of the
window loses less, costs a few known seeds, and saves a test of hundreds of episodes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.between import factor
from pytest_tarl.searching.accept import Reference
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Pair, Trials

THIN = 0.5  # share of the margin that may be lost before a better value is looked for
STEPS = (1.12, 1.04)  # ratios of neighbouring values
SEEDS = 3  # that values are compared on
MOVES = 3  # in one direction, at one ratio


def centred(
    candidate: Candidate, trials: Trials, mutate: Mutate, goal: Goal, reference: Reference
) -> Candidate:
    """Return a candidate with the value that earns most on known seeds, climbing from the one that was found.

    What fails on them, or loses little, is returned as it is. Raises BudgetSpentError.
    """
    pairs = goal.pairs[:SEEDS]
    harder = fmean(goal.harder.get(pair.seed, 0.0) for pair in pairs)
    enough = reference.mean - THIN * reference.margin - harder
    try:
        if all(goal.reached(trials(candidate, pair.seed), pair.seed) for pair in pairs):
            return _climbed(candidate, trials, mutate, pairs, enough)
    except RepairError:
        return candidate
    return candidate


def _climbed(
    candidate: Candidate, trials: Trials, mutate: Mutate, pairs: Sequence[Pair], enough: float
) -> Candidate:
    best, most = candidate, _mean(candidate, trials, pairs)
    for step in STEPS:
        for ratio in (step, 1 / step):
            for _ in range(MOVES):
                moved = _moved(best, ratio, mutate) if most < enough else None
                earned = _mean(moved, trials, pairs) if moved is not None else most
                if moved is None or earned <= most:
                    break
                best, most = moved, earned
    return best


def _moved(candidate: Candidate, ratio: float, mutate: Mutate) -> Candidate | None:
    """Return a candidate with its only value a little further or nearer; None where it has several, or a sign."""
    moved: list[Mutation] = []
    for one in candidate.mutations:
        by = float(one.value) if one.form is not None and one.form.parameter else factor(one)
        if by is None or one.operand.site != candidate.mutations[0].operand.site:
            return None
        further = replace(one, value=by * ratio) if one.form is not None else mutate(one.operand, by * ratio)
        if further is None:
            return None
        moved.append(further)
    return replace(candidate, mutations=tuple(moved))


def _mean(candidate: Candidate, trials: Trials, pairs: Sequence[Pair]) -> float:
    try:
        return fmean(trials(candidate, pair.seed).total for pair in pairs)
    except RepairError:
        return float("-inf")
