"""Improve the value of a candidate that passes but loses much of the margin, before its expensive test.

A test can hardly distinguish a loss of more than half of the margin from a loss of the whole margin. The candidate was
chosen on the known seeds, so its mean reward there is too high: a candidate that loses a third of the margin on known
seeds may lose half of it on other seeds. A value in the middle of the range of good values loses less. Finding such a
value takes a few episodes on known seeds and can save a test of hundreds of episodes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import Mutation, to_step
from pytest_tarl.repairing.between import on_grid, searched_step
from pytest_tarl.searching.accept import Reference
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials

THIN = 0.35  # candidates that lose less than this share of the margin are not improved
STEPS = (1.3, 1.12, 1.04)  # ratios between neighbouring values, tried in this order
SEEDS = 5  # maximum number of seeds on which to compare values
BEHIND = 2  # number of seeds after which a value is dropped if it earned less than the best value
MOVES = 3  # maximum number of moves in one direction with one ratio
# if a value fails on some seeds, values with these ratios to it are tried instead
ASIDE = (1.25, 0.8, 1.12, 0.89)


def centred(
    candidate: Candidate,
    trials: Trials,
    mutate: Mutate,
    goal: Goal,
    reference: Reference,
    examined: Callable[[Candidate], bool],
) -> Candidate:
    """Return the candidate with the best value found by hill climbing on known seeds.

    The climb ends when it reaches a value that was `examined` before, because the steps from there were tried then. A
    candidate that fails on these seeds, or that loses little, is returned unchanged. The loss is the difference from
    the designed missions of these seeds: if the designed missions also earn less than the mean, a better value would
    only be fitted to a few starts. Raise BudgetSpentError.
    """
    pairs = sorted(goal.pairs, key=lambda pair: not trials.ran(candidate, [pair]))[:SEEDS]
    harder = fmean(goal.harder.get(pair.seed, 0.0) for pair in pairs)
    enough = reference.mean - THIN * reference.margin - harder
    try:
        if all(trials.reaches(candidate, pair.seed, goal) for pair in pairs):
            if _loses_little(
                candidate, trials, goal, [pair.seed for pair in pairs], enough, reference.margin
            ):
                return candidate
            among = replace(goal, pairs=tuple(pairs))
            return _climbed(candidate, trials, mutate, among, enough, examined)
    except RepairError:
        return candidate
    return candidate


def _loses_little(
    candidate: Candidate, trials: Trials, goal: Goal, seeds: Sequence[int], enough: float, margin: float
) -> bool:
    """Return whether a candidate earns less than `enough` but nearly as much as the designed missions."""
    if goal.harder or fmean(trials(candidate, seed).total for seed in seeds) >= enough:
        return False
    lost = trials.lost(candidate, seeds)
    return lost is not None and lost <= THIN * margin


def neighbours(candidate: Candidate, mutate: Mutate) -> Iterator[Candidate]:
    """Yield the candidate with slightly smaller and larger values.

    Yield nothing if the candidate changes several constants or has no factor.
    """
    for ratio in ASIDE:
        other = moved(candidate, ratio, mutate)
        if other is not None:
            yield in_place(other)


def in_place(candidate: Candidate) -> Candidate:
    """Return the candidate with its changes moved from the definitions of the constants to their uses."""
    return replace(candidate, mutations=candidate.changes)


def _climbed(
    candidate: Candidate,
    trials: Trials,
    mutate: Mutate,
    goal: Goal,
    enough: float,
    examined: Callable[[Candidate], bool],
) -> Candidate:
    """Climb on the seeds of the goal's first pairs until no step in either direction is better."""
    best, totals = candidate, [trials(candidate, pair.seed).total for pair in goal.pairs[:SEEDS]]
    for step in STEPS:
        for ratio in (step, 1 / step):
            for _ in range(MOVES):
                other = moved(best, ratio, mutate) if fmean(totals) < enough else None
                earned = _better(other, trials, goal, totals) if other is not None else None
                if other is None or earned is None or _at_the_edge(moved(other, ratio, mutate), trials, goal):
                    break
                best, totals = other, earned
                if examined(best):
                    return best
        near = (moved(candidate, ratio, mutate) for ratio in (step, 1 / step))
        if all(one is not None and trials.same_as(one, candidate) for one in near):
            return candidate  # this step has no effect, so smaller steps have none either
    return best


def _at_the_edge(further: Candidate | None, trials: Trials, goal: Goal) -> bool:
    """Return whether a mission fails one step further. The reward may grow until missions suddenly fail."""
    if further is None or not goal.passing:
        return False
    try:
        return goal.lost(trials(further, goal.pairs[0].seed))
    except RepairError:
        return True


def moved(candidate: Candidate, ratio: float, mutate: Mutate) -> Candidate | None:
    """Return a candidate with its value scaled by `ratio`, except a parameter on a grid.

    Return None if the candidate changes several constants in several statements, or has no factor.
    """
    made: list[Mutation] = []
    if all(map(on_grid, candidate.mutations)):
        return None
    for one in candidate.mutations:
        if on_grid(one):
            made.append(one)
            continue
        by = searched_step(one)
        first = candidate.mutations[0].operand
        alike = one.operand.site == first.site or one.operand.definition == first.definition is not None
        if by is None or not alike:
            return None
        further = to_step(one, by * ratio, mutate)
        if further is None:
            return None
        made.append(further)
    return replace(candidate, mutations=tuple(made))


def _better(candidate: Candidate, trials: Trials, goal: Goal, totals: Sequence[float]) -> list[float] | None:
    """Return a candidate's totals if their mean is higher than that of `totals`.

    Return None as soon as the candidate falls behind or a mission fails. Also return None if the candidate loses reward
    in the same missions as rejected candidates.
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
