"""Confidence interval of the shift between two groups, by inverting a studentised permutation test.

It is exact if the groups differ by a constant (Janssen 1997), however skewed they are.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, inf

import numpy as np

from pytest_tarl.learning.permutation import ARITHMETIC
from pytest_tarl.learning.roots import root
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.seeds import generator

COARSE = 30  # halvings; p-values from shuffles are less precise than floats
LEAST_PERMUTATIONS = 999
PER_RISK = 20  # permutations expected beyond the statistic at the requested risk
MOST_PERMUTATIONS = 40_000
AT_ONCE = 2_000  # shuffles drawn together, which take a few MB


def shifts(offline: Floats, online: Floats, risk: float) -> tuple[float, float]:
    """Return the least and the largest shift that a permutation test at `risk` does not reject; inputs (episodes,)."""
    difference = float(offline.mean() - online.mean())
    unit = float(np.ptp(offline) + np.ptp(online))  # beyond this shift, the groups do not overlap
    if unit <= ARITHMETIC * float(np.abs(np.concatenate((offline, online))).max()):
        return difference - unit, difference + unit
    before, after = (offline - offline.mean()) / unit, (online - online.mean()) / unit
    shuffles = min(max(LEAST_PERMUTATIONS, ceil(PER_RISK / risk)), MOST_PERMUTATIONS)
    drawn = _drawn(offline.size + online.size, online.size, shuffles)

    def refuted(shift: float, sign: float) -> bool:
        """Return whether the deployed group, shifted by this amount, is significantly too low (or too high)."""
        pooled = sign * np.concatenate((after + shift, before))
        return _studentised_p(pooled - pooled.mean(), online.size, drawn) <= risk

    if not refuted(-1.0, 1.0) or not refuted(1.0, -1.0):
        return -inf, inf  # too few permutations to reject anything
    low = root(lambda by: refuted(by - 1.0, 1.0), 0.0, 1.0, COARSE) - 1.0
    high = 1.0 - root(lambda by: refuted(1.0 - by, -1.0), 0.0, 1.0, COARSE)
    return difference + unit * low, difference + unit * high


@lru_cache(maxsize=8)
def _drawn(rows: int, chosen: int, shuffles: int) -> Ints:
    """Return the rows of one group in many shuffles, shape (shuffles, chosen)."""
    draws = generator(0, f"shifts/{rows}/{chosen}")
    parts = [
        np.argpartition(draws.random((min(AT_ONCE, shuffles - done), rows)), chosen - 1, axis=1)[:, :chosen]
        for done in range(0, shuffles, AT_ONCE)
    ]
    return np.concatenate(parts).astype(np.int64)


def _studentised_p(pooled: Floats, first: int, drawn: Ints) -> float:
    """Return the one-sided p-value of the first group being lower, by t statistics of unequal variances."""
    total, squares = float(pooled.sum()), float((pooled * pooled).sum())
    groups = np.concatenate((np.arange(first)[None, :], drawn))
    one = pooled[groups]
    added, squared = one.sum(axis=1), (one * one).sum(axis=1)
    rest = pooled.size - first
    variance = [
        np.maximum(twos - sums * sums / size, 0.0) / (max(size - 1, 1) * size)
        for sums, twos, size in ((added, squared, first), (total - added, squares - squared, rest))
    ]
    scale = np.sqrt(variance[0] + variance[1])
    apart = added / first - (total - added) / rest
    with np.errstate(divide="ignore", invalid="ignore"):
        statistic = np.where(scale > 0, apart / scale, np.sign(apart) * inf)
    return int((statistic <= statistic[0] + 1e-9).sum()) / int(statistic.size)
