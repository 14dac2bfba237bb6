"""If only a few missions fail, find more seeds with failing missions, and the designed reward of these seeds.

If only a few missions fail, they often have something in common, such as a person on the road. This makes them harder
in the designed world, too, so no repair can be expected to reach the recorded mean on them. Each mission is therefore
compared with the designed mission of the same seed. The acceptance test draws fresh seeds, so this selection does not
bias it.

On a few of these missions, a repair may earn even less than the designed mission of the same seed. For example, a rover
that skips its longest round in the frost loses a fifth of the reward in one of eight missions. The average loss is only
2.5 %.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from pytest_tarl.learning.tables import Sample
from pytest_tarl.repairing.mutants import ORIGINAL, Mutants
from pytest_tarl.searching.confirming import CONFIRMATIONS
from pytest_tarl.searching.search import BudgetSpentError, Goal, Pair, Trials

ENOUGH = 1 + CONFIRMATIONS  # a search needs this number of seeds with a loss
LOOKED_AT = 12  # maximum number of recorded missions that are run under the drift to find seeds with a loss
SELECTED = 0.5  # if at least this share of the episodes fails, the failing episodes represent all episodes
SHARE = 0.6  # the selected missions may use up this share of the margin
HALF = 0.5  # a repaired mission may keep at most this share of its loss
CONTROLS = 2  # number of drifted episodes without a loss in which a candidate must not lose reward


def enriched(mutants: Mutants, trials: Trials) -> Goal:
    """Return the goal, extended by failing seeds and by the designed reward of each seed.

    The episodes are charged to the budget. If the budget does not suffice, the goal is returned unchanged. If most
    drifted episodes lose reward, no episode is run and the goal is returned unchanged, too.
    """
    order = mutants.order
    goal, online = order.goal, order.online.recorded.sample
    columns = zip(online.seeds, online.total.tolist(), online.steps.tolist(), strict=True)
    every = [Pair(seed, total, steps) for seed, total, steps in columns]
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
    seldom = SHARE * order.reference.margin * len(every) / len(lost) - order.reference.margin
    tolerated = {
        pair.seed: max(min(seldom, HALF * (mean - harder[pair.seed] - pair.total) - slack), 0.0)
        for pair in pairs
    }
    controls = tuple(held[:CONTROLS])
    return replace(goal, pairs=tuple(pairs), harder=harder, tolerated=tolerated, controls=controls)


def _run(mutants: Mutants, trials: Trials, seed: int, drift: str | None) -> float:
    """Return the total reward of the unrepaired program. Raise BudgetSpentError."""
    trials.charge()
    total: float = mutants.run(ORIGINAL, seed, drift).total
    return total


def _likely(recorded: Sample, online: Sample, lost: set[int]) -> Iterator[tuple[int, float]]:
    """Yield (seed, total) of the recorded missions that are likely to lose reward under the drift, likeliest first.

    Each bin of a sensor has a score: the share of drifted episodes with a loss that visit the bin, minus the same share
    of the episodes without a loss. The score of a mission is the highest score of the bins that it visits. Bins of
    single sensors are scored instead of cells, because one sensor may suffice to detect the drift.
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
    """Return which bins each episode visited, boolean of shape (episodes, bins)."""
    visited = np.zeros((sample.episodes, len(order)), dtype=bool)
    for sensor in range(len(sample.cells[0]) if sample.cells else 0):
        columns = np.array([order[sensor, cell[sensor]] for cell in sample.cells])
        visited[sample.chain.episode, columns[sample.chain.cell]] = True
    return visited
