"""Improve the value of a candidate that holds but loses much of the margin, before its expensive test.

A loss of more than half of the margin is hard to distinguish from a loss of all of it. The mean over a few known seeds,
on which the candidate was chosen, is too high, so a third of the margin there may be half of it elsewhere. A value
closer to the middle of the candidate's window loses less; finding it costs a few known seeds and saves a test of
hundreds of episodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import Mutation, to_step
from pytest_tarl.repairing.between import on_grid, searched_step
from pytest_tarl.searching.accept import Reference
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials

THIN = 0.35  # share of the margin; candidates that lose less are not improved
STEPS = (1.3, 1.12, 1.04)  # ratios of neighbouring values
SEEDS = 5  # seeds on which to compare values; a value that falls behind runs on fewer
BEHIND = 2  # seeds after which a value that earned less is dropped
MOVES = 3  # maximum number of moves in one direction with one ratio
ASIDE = (1.25, 0.8, 1.12, 0.89)  # ratios to the neighbours of a value that fails on some seeds


def centred(
    candidate: Candidate, trials: Trials, mutate: Mutate, goal: Goal, reference: Reference
) -> Candidate:
    """Return the candidate with the best value found by hill climbing on known seeds.

    A candidate that fails on these seeds, or loses little, is returned unchanged. Raises BudgetSpentError.
    """
    pairs = goal.pairs[:SEEDS]
    harder = fmean(goal.harder.get(pair.seed, 0.0) for pair in pairs)
    enough = reference.mean - THIN * reference.margin - harder
    try:
        if all(goal.reached(trials(candidate, pair.seed), pair.seed) for pair in pairs):
            return _climbed(candidate, trials, mutate, goal, enough)
    except RepairError:
        return candidate
    return candidate


def neighbours(candidate: Candidate, mutate: Mutate) -> Iterator[Candidate]:
    """Yield a candidate with its value moved to either side; nothing for several sites or without a factor."""
    for ratio in ASIDE:
        other = moved(candidate, ratio, mutate)
        if other is not None:
            yield in_place(other)


def in_place(candidate: Candidate) -> Candidate:
    """Return a candidate that changes its constants where they are used."""
    return replace(candidate, mutations=candidate.changes)


def _climbed(candidate: Candidate, trials: Trials, mutate: Mutate, goal: Goal, enough: float) -> Candidate:
    best, totals = candidate, [trials(candidate, pair.seed).total for pair in goal.pairs[:SEEDS]]
    for step in STEPS:
        for ratio in (step, 1 / step):
            for _ in range(MOVES):
                other = moved(best, ratio, mutate) if fmean(totals) < enough else None
                earned = _better(other, trials, goal, totals) if other is not None else None
                if other is None or earned is None:
                    break
                best, totals = other, earned
    return best


def moved(candidate: Candidate, ratio: float, mutate: Mutate) -> Candidate | None:
    """Return a candidate with its value scaled by `ratio`, powers and the like unchanged.

    None for several sites, or if nothing has a factor.
    """
    made: list[Mutation] = []
    if all(map(on_grid, candidate.mutations)):
        return None
    for one in candidate.mutations:
        if on_grid(one):
            made.append(one)
            continue
        by = searched_step(one)
        if by is None or one.operand.site != candidate.mutations[0].operand.site:
            return None
        further = to_step(one, by * ratio, mutate)
        if further is None:
            return None
        made.append(further)
    return replace(candidate, mutations=tuple(made))


def _better(candidate: Candidate, trials: Trials, goal: Goal, totals: Sequence[float]) -> list[float] | None:
    """Return a candidate's totals if they are higher in the mean than these.

    None as soon as it falls behind or a mission fails, even if that one earns more, and if it loses missions that
    rejected candidates lost.
    """
    earned: list[float] = []
    try:
        for pair in goal.pairs[:SEEDS]:
            outcome = trials(candidate, pair.seed)
            if goal.lost(outcome):
                return None
            earned.append(outcome.total)
            if len(earned) >= BEHIND and fmean(earned) <= fmean(totals[: len(earned)]):
                return None
        lost = trials.loses(candidate)
    except RepairError:
        return None
    return None if lost else earned
