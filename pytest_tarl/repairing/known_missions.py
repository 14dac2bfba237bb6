"""Try a candidate on missions that are already known, before its test on fresh seeds."""

from __future__ import annotations

from statistics import fmean

from pytest_tarl.model import Reason
from pytest_tarl.repairing.ledger import operands
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
    goal, slack = order.goal, order.reference.mean - order.goal.near
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
    return "nominal gets worse" if harmed(mutants, candidate, trials, missed) else ""


def harmed(mutants: Mutants, candidate: Candidate, trials: Trials, missed: Missed) -> bool:
    """Return whether a candidate makes a recorded mission worse. Raise BudgetSpentError and RepairError."""
    seeds = firing(mutants.order, candidate)[:QUICK]
    mutants.foresee([(candidate, seed) for seed in seeds if (candidate, seed) not in missed.designed], None)
    for seed in seeds:
        if _harms(mutants, candidate, seed, trials, missed):
            missed.harmed.setdefault(operands(candidate), seed)
            return True
    return False


def lost_as_designed(mutants: Mutants, candidate: Candidate, missed: Missed) -> float:
    """Return a candidate's mean loss in the recorded missions that it has run; 0 if it has run none."""
    recorded = _recorded(mutants.order)
    lost = [recorded[seed] - total for (one, seed), total in missed.designed.items() if one == candidate]
    return fmean(lost) if lost else 0.0


def harms_again(mutants: Mutants, candidate: Candidate, trials: Trials, missed: Missed) -> bool:
    """Return whether a candidate harms a recorded mission that an earlier change of the same constants harmed.

    This one mission then shows that the new value or condition is as harmful as the earlier one. Raise BudgetSpentError
    and RepairError.
    """
    seed = missed.harmed.get(operands(candidate))
    if seed is None or seed not in firing(mutants.order, candidate):
        return False
    return _harms(mutants, candidate, seed, trials, missed)


def _harms(mutants: Mutants, candidate: Candidate, seed: int, trials: Trials, missed: Missed) -> bool:
    """Return whether a candidate earns clearly less in a recorded mission. The mission runs and is charged once."""
    order = mutants.order
    if (candidate, seed) not in missed.designed:
        trials.charge()
        missed.designed[candidate, seed] = mutants.run(candidate, seed, None).total
    least = _recorded(order)[seed] - (order.reference.mean - order.goal.near)
    return missed.designed[candidate, seed] < least


def _recorded(order: Order) -> dict[int, float]:
    """Return the total reward of each recorded mission, by seed."""
    offline = order.fixture.sample
    return dict(zip(offline.seeds, offline.total.tolist(), strict=True))


def firing(order: Order, candidate: Candidate) -> tuple[int, ...]:
    """Return the seeds of recorded episodes in which the guard holds; empty if the drift is permanent."""
    if order.permanent:
        return ()
    return candidates.firing_episodes(candidate.guard, order.fixture.sample, order.comparison.sensors)
