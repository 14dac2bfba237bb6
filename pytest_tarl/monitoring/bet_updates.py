"""Update the bets with new missions, for one or more robots at once.

The first columns are the bounds (each for all robots), followed by the scores (robot by robot). Columns are
independent, so a robot's result is the same, to the last bit, as if it were judged alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring import conformal, e_process, restarts
from pytest_tarl.monitoring.restarts import Processes
from pytest_tarl.monitoring.stated import Bound

Truths = NDArray[np.bool_]


def judged(
    bounds: Sequence[Bound],
    processes: Processes,
    pool: Ints,
    passed: Truths,
    total: Floats,
    bins: Ints,
    draws: Floats,
    first: int,
    ends: Ints | None = None,
    onsets: bool = True,
) -> Ints:
    """Update the processes with consecutive missions of each robot; return the updated pool.

    - `passed`, `total`: shape (missions, robots)
    - `bins`: shape (missions, robots, scores); -1 for a missing mission
    - `draws`: shape (missions,)
    - `pool`: shape (robots · scores, BINS)
    - `first`: number of the first mission
    - `ends`, shape (robots,): the numbers of missions, if robots have different numbers
    - `onsets`: False skips tracking the start of differences, which is faster

    There may be at most conformal.TOGETHER missions.
    """
    count, robots, scores = bins.shape
    flat, split = bins.reshape(count, robots * scores), len(bounds) * robots
    there = np.full(passed.shape, True) if ends is None else np.arange(count)[:, None] < ends
    taken = np.concatenate((*(_told(bound, total) & there for bound in bounds), flat >= 0), axis=1)
    factors = np.empty((count, restarts.BETS, processes.count))
    for row, bound in enumerate(bounds):
        factors[:, :, row * robots : (row + 1) * robots] = _against(bound, passed, total)
    low, high = conformal.ranks(pool, flat, draws)
    conformal.factors(low, high, factors[:, :, split:])
    np.copyto(factors, 1.0, where=~taken[:, None, :])
    last = None if ends is None else np.concatenate((np.tile(ends, len(bounds)), np.repeat(ends, scores)))
    restarts.advance(processes, taken, factors, first, last, onsets)
    return conformal.joined(pool, flat)


def begun(threshold: Floats, bounds: int, robots: int) -> Processes:
    """Return the processes of several robots before their first mission.

    `threshold`, of shape (bounds + scores,), has the values for a single robot.
    """
    return restarts.begun(
        np.append(np.repeat(threshold[:bounds], robots), np.tile(threshold[bounds:], robots))
    )


def columns(bounds: int, scores: int, robots: int, robot: int) -> Ints:
    """Return the columns of one robot, shape (bounds + scores,)."""
    rows = np.append(np.arange(bounds) * robots + robot, bounds * robots + robot * scores + np.arange(scores))
    return rows.astype(np.int64)


def _told(bound: Bound, total: Floats) -> Truths:
    """Return which missions count for a bound, as booleans of the same shape as the totals."""
    testable = e_process.testable(float(bound.share(bound.least)))
    told: Truths = testable & (np.isfinite(total) | (bound.what == "success"))
    return told


def _against(bound: Bound, passed: Truths, total: Floats) -> Floats:
    """Return the factors of the bets against a bound, shape (missions, bets, robots)."""
    least = float(bound.share(bound.least))
    if not e_process.testable(least):
        return np.ones((1, 1, 1))
    observed = passed.astype(np.float64) if bound.what == "success" else total
    each = e_process.factors(least, bound.share(observed).ravel())
    return each.reshape(*passed.shape, -1).transpose(0, 2, 1)
