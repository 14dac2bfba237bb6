"""Try a candidate on missions that are already known, before its test on fresh seeds."""

from __future__ import annotations

from pytest_tarl.model import Reason
from pytest_tarl.repairing.missed import Missed
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching import candidates
from pytest_tarl.searching.search import Candidate, Trials

QUICK = 3  # number of known seeds on which a guard is tried, in each world


def known_to_fail(mutants: Mutants, candidate: Candidate, trials: Trials, missed: Missed) -> Reason:
    """Return why a candidate fails on known episodes, or "" if it does not fail.

    Known episodes are drifted episodes with a loss, a few drifted episodes without a loss, and recorded episodes in
    which the guard holds. Raise BudgetSpentError and RepairError.
    """
    order = mutants.order
    goal, offline = order.goal, order.fixture.sample
    known = dict(zip(offline.seeds, offline.total.tolist(), strict=True))
    slack = order.reference.mean - goal.near
    trials.expect((candidate, pair.seed) for pair in goal.pairs[:QUICK])
    for pair in goal.pairs[:QUICK]:
        if not trials.reaches(candidate, pair.seed, goal):
            trials.misses[pair.seed] += 1
            return "gain too small"
    if missed.again(candidate, trials, goal):
        return "gain too small"
    for pair in goal.controls:
        outcome = trials(candidate, pair.seed)
        if outcome.total < pair.total - slack or goal.lost(outcome):
            return "breaks other missions"
    seeds = firing(order, candidate)[:QUICK]
    mutants.foresee([(candidate, seed) for seed in seeds], None)
    for seed in seeds:
        trials.charge()
        if mutants.run(candidate, seed, None).total < known[seed] - slack:
            return "nominal gets worse"
    return ""


def firing(order: Order, candidate: Candidate) -> tuple[int, ...]:
    """Return the seeds of recorded episodes in which the guard holds; empty if the drift is permanent."""
    if order.permanent:
        return ()
    return candidates.firing_episodes(candidate.guard, order.fixture.sample, order.comparison.sensors)
