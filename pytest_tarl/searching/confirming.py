"""Confirm a candidate: it must pass on further seeds and earn about as much as designed missions.

Missions that lost much reward are often hard ones, for example because the way is longer. They earn less in the
designed world, too. A candidate may pass on the seeds of such missions and still earn less than the mean designed
mission. It is then compared with the designed missions of the same seeds.
"""

from __future__ import annotations

from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.searching.search import Candidate, Goal, Trials

CONFIRMATIONS = 5  # number of further seeds on which a promising candidate must earn enough
HARD = 2  # maximum number of confirmation seeds that are chosen because other candidates failed on them
SHORT = 3  # a candidate is rejected after this number of missions if each mission clearly earned too little


def confirmed(candidate: Candidate, trials: Trials, goal: Goal, first: int) -> bool:
    """Return whether a candidate passes on further seeds, starting after `goal.pairs[first]`.

    The seeds on which other candidates earned too little run first. A candidate is rejected early

    - if it loses missions that ran in the tests of rejected candidates,
    - at its first failed mission, if missions succeed in the designed world and the drift's size does not vary,
    - at its second seed with too little reward,
    - if its mean total is estimated to be too low (`falls_short`),
    - if each of its first `SHORT` missions clearly earns too little, and also less than the designed missions of the
      same seeds.
    """
    if trials.loses(candidate):
        return False
    seeds = _hardest_first(trials, goal, first)
    ran: list[int] = []
    trials.expect((candidate, seed) for seed in seeds)
    missed = 0
    as_designed = False
    for seed in seeds:
        outcome = trials(candidate, seed)
        ran.append(seed)
        if not trials.reaches(candidate, seed, goal):
            missed += 1
            trials.misses[seed] += 1
        if missed > 1 or (goal.lost(outcome) and not goal.ranged):
            return False
        if trials.falls_short(candidate, goal.pairs, goal.enough):
            return False
        if not as_designed and _always_short(candidate, trials, goal):
            as_designed = not missed and _earns_as_designed(candidate, trials, goal)
            if not as_designed:
                break
    earned = [trials(candidate, seed).total for seed in ran]
    holds = not earned or fmean(earned) >= goal.enough_on(ran)
    if not holds and not missed:
        holds = _earns_as_designed(candidate, trials, goal)
        if not holds:
            trials.fell_short(candidate, goal.pairs)
    return holds


def suffices(candidate: Candidate, trials: Trials, goal: Goal) -> bool:
    """Return whether a candidate reaches the goal on the first seed and is confirmed on further seeds.

    Return False if the candidate cannot be written into the source. Raise BudgetSpentError.
    """
    try:
        return trials.reaches(candidate, goal.pairs[0].seed, goal) and confirmed(candidate, trials, goal, 0)
    except RepairError:
        return False


def _earns_as_designed(candidate: Candidate, trials: Trials, goal: Goal) -> bool:
    """Return whether a candidate loses at most the margin, compared with designed missions of the same seeds.

    If only a few missions lose reward, the goal already contains the designed reward of each of their seeds.
    """
    if goal.margin is None or goal.harder:
        return False
    lost = trials.lost(candidate, list(trials.totals_of(candidate, goal.pairs)))
    return lost is not None and lost <= goal.margin


def _always_short(candidate: Candidate, trials: Trials, goal: Goal) -> bool:
    """Return whether at least `SHORT` missions ran and each earned less than halfway from `near` to `enough`."""
    totals, least = trials.totals_of(candidate, goal.pairs), (goal.enough - goal.near) / 2
    return len(totals) >= SHORT and all(
        total < goal.enough_on([seed]) - least for seed, total in totals.items()
    )


def _hardest_first(trials: Trials, goal: Goal, first: int) -> list[int]:
    """Return the confirmation seeds: up to `HARD` seeds that most candidates failed, then the seeds after `first`."""
    others = [goal.pairs[(first + i) % len(goal.pairs)].seed for i in range(1, len(goal.pairs))]
    missed = [seed for seed in others if trials.misses[seed]]
    hard = sorted(missed, key=lambda seed: -trials.misses[seed])[:HARD]
    return [*hard, *(seed for seed in others if seed not in hard)][:CONFIRMATIONS]
