"""Where few missions fail: further seeds whose missions fail, and what each of them earns as designed.

Missions that fail seldom do so for a reason, a person on the road for instance, and such missions are harder in the
designed world, too: they are a selection, so the off-line mean is not what a repair can reach on them. Each is
therefore held against the designed mission of its own seed. Acceptance draws fresh seeds, so the selection biases
nothing that is promised.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from pytest_tarl.learning.tables import Sample
from pytest_tarl.repairing.mutants import ORIGINAL, Mutants
from pytest_tarl.searching.search import CONFIRMATIONS, BudgetSpentError, Goal, Pair, Trials

ENOUGH = 1 + CONFIRMATIONS  # seeds that a candidate is tried on
LOOKED_AT = 12  # recorded missions that are run under the drift, to find such seeds
SELECTED = 0.5  # share of the on-line episodes; where more lose, they are no selection
CONTROLS = 2  # on-line episodes that did not lose, in which a candidate must not lose either


def enriched(mutants: Mutants, trials: Trials) -> Goal:
    """Return the goal with enough seeds that lose, each beside what it earns as designed; episodes are charged.

    Nothing is run where most on-line episodes lose. The goal stays as it was where the budget does not suffice.
    """
    order = mutants.order
    goal, online = order.goal, order.online.recorded.sample
    every = [Pair(seed, total) for seed, total in zip(online.seeds, online.total.tolist(), strict=True)]
    lost = [pair for pair in every if pair.total < goal.near]
    if not lost or len(lost) >= SELECTED * len(every):
        return goal
    pairs = list(goal.pairs[:ENOUGH])
    mean, slack = order.reference.mean, order.reference.mean - goal.near
    try:
        harder = {pair.seed: max(mean - _run(mutants, trials, pair.seed, None), 0.0) for pair in pairs}
        likely = _likely(order.fixture.sample, online, {pair.seed for pair in lost})
        for seed, designed in islice(likely, LOOKED_AT if order.drift else 0):
            if len(pairs) >= ENOUGH:
                break
            total = _run(mutants, trials, seed, order.drift)
            if total < designed - slack:
                pairs.append(Pair(seed, total))
                harder[seed] = max(mean - designed, 0.0)
    except BudgetSpentError:
        return goal
    held = [pair for pair in every if pair not in lost]
    return replace(goal, pairs=tuple(pairs), harder=harder, controls=tuple(held[:CONTROLS]))


def _run(mutants: Mutants, trials: Trials, seed: int, drift: str | None) -> float:
    """Return what the program earns as it is."""
    trials.charge()
    total: float = mutants.run(ORIGINAL, seed, drift).total
    return total


def _likely(recorded: Sample, online: Sample, lost: set[int]) -> Iterator[tuple[int, float]]:
    """Yield recorded missions, seeds and totals, that are likely to lose under the drift, the likeliest first.

    A mission counts by the bin on its way that tells most: the share of the lost on-line episodes in which that sensor
    was in that bin, less the share of the others. Bins and not cells are compared, as one sensor may tell the drift.
    """
    bins = {place for sample in (recorded, online) for cell in sample.cells for place in enumerate(cell)}
    order = {place: at for at, place in enumerate(sorted(bins))}
    was = _visited(online, order)
    of_lost = np.array([seed in lost for seed in online.seeds])
    telling = was[of_lost].mean(axis=0) - was[~of_lost].mean(axis=0)
    merit = np.where(_visited(recorded, order), telling, -1.0).max(axis=1)
    for at in np.argsort(-merit, kind="stable").tolist():
        yield recorded.seeds[at], float(recorded.total[at])


def _visited(sample: Sample, order: dict[tuple[int, int], int]) -> np.ndarray:
    """Tell which bins each episode was in, shape (episodes, bins)."""
    visited = np.zeros((sample.episodes, len(order)), dtype=bool)
    for sensor in range(len(sample.cells[0]) if sample.cells else 0):
        columns = np.array([order[sensor, cell[sensor]] for cell in sample.cells])
        visited[sample.chain.episode, columns[sample.chain.cell]] = True
    return visited
