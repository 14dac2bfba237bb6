"""Compute a confidence interval for the shift between two groups by inverting a studentised permutation test.

The interval is exact if the groups differ by a constant, even if they are skewed (Janssen 1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, inf

import numpy as np

from pytest_tarl.learning.enumeration import enumerable, other_groups
from pytest_tarl.learning.permutation import ARITHMETIC
from pytest_tarl.learning.roots import root
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.seeds import generator

COARSE = 30  # bisection steps; p-values from shuffles are not precise enough for more
LEAST_PERMUTATIONS = 999
# number of shuffles expected to be more extreme at the requested risk
PER_RISK = 20
MOST_PERMUTATIONS = 40_000
AT_ONCE = 2_000  # number of shuffles drawn at once; takes a few MB


def shifts(offline: Floats, online: Floats, risk: float) -> tuple[float, float]:
    """Return the smallest and largest shift that a permutation test at `risk` does not reject.

    Inputs have shape (episodes,). The interval is infinite if there are too few permutations to reject anything.
    """
    difference = float(offline.mean() - online.mean())
    # a shift by more than this separates the groups completely
    unit = float(np.ptp(offline) + np.ptp(online))
    if unit <= ARITHMETIC * float(np.abs(np.concatenate((offline, online))).max()):
        return difference - unit, difference + unit
    before, after = (offline - offline.mean()) / unit, (online - online.mean()) / unit
    shuffles = min(max(LEAST_PERMUTATIONS, ceil(PER_RISK / risk)), MOST_PERMUTATIONS)
    drawn = _drawn(offline.size + online.size, online.size, shuffles)
    rows = np.concatenate((np.arange(online.size)[None, :], drawn))
    group, whole = (_sums(after, before, some) for some in (rows, np.arange(offline.size + online.size)))

    def refuted(shift: float, sign: float) -> bool:
        """Return whether the deployed group, shifted by this, is significantly too low (or too high)."""
        return _studentised_p(group, whole, shift, sign) <= risk

    if not refuted(-1.0, 1.0) or not refuted(1.0, -1.0):
        return -inf, inf  # there are too few permutations to reject any shift
    low = root(lambda by: refuted(by - 1.0, 1.0), 0.0, 1.0, COARSE) - 1.0
    high = 1.0 - root(lambda by: refuted(1.0 - by, -1.0), 0.0, 1.0, COARSE)
    return difference + unit * low, difference + unit * high


@lru_cache(maxsize=8)
def _drawn(rows: int, chosen: int, shuffles: int) -> Ints:
    """Return the rows of the first group in each shuffle, shape (groups, chosen).

    The observed group is left out. There are fewer groups than `shuffles` if the samples allow no more.
    """
    if enumerable(rows, chosen, shuffles):
        return other_groups(rows, chosen)
    draws = generator(0, f"shifts/{rows}/{chosen}")
    parts = [
        np.argpartition(draws.random((min(AT_ONCE, shuffles - done), rows)), chosen - 1, axis=1)[:, :chosen]
        for done in range(0, shuffles, AT_ONCE)
    ]
    return np.concatenate(parts).astype(np.int64)


@dataclass(frozen=True)
class _Sums:
    """Sums over the rows of a group: x is a row's value, and d is 1 for a deployed episode, otherwise 0.

    The sums have shape (shuffles,), or () for a single group. Because d² = d, they give the sums of x + t·d and of (x +
    t·d)² for every shift t.
    """

    rows: int
    value: Floats  # Σx
    square: Floats  # Σx²
    deployed: Floats  # Σd
    deployed_value: Floats  # Σx·d

    def around(self, mean: float, shift: float) -> tuple[Floats, Floats]:
        """Return Σ(x + t·d - m) and Σ(x + t·d - m)² for mean m and shift t, in the shape of the sums."""
        value = self.value + shift * self.deployed
        square = self.square + shift * (2.0 * self.deployed_value + shift * self.deployed)
        return value - mean * self.rows, square - 2.0 * mean * value + mean * mean * self.rows


def _sums(deployed: Floats, designed: Floats, rows: Ints) -> _Sums:
    """Return the sums over the given rows, shape (..., rows of a group), of all deployed and designed values."""
    values = np.concatenate((deployed, designed))
    owned = np.append(np.ones(deployed.size), np.zeros(designed.size))
    columns = (values, values * values, owned, values * owned)
    return _Sums(rows.shape[-1], *(column[rows].sum(axis=-1) for column in columns))


def _studentised_p(group: _Sums, whole: _Sums, shift: float, sign: float) -> float:
    """Return the one-sided p-value for a shifted group being lower (t for unequal variances).

    The first row of `group` is the observed one.
    """
    mean = float(whole.value + shift * whole.deployed) / whole.rows
    (added, squared), (total, squares) = (one.around(mean, shift) for one in (group, whole))
    rest = whole.rows - group.rows
    variance = [
        np.maximum(twos - sums * sums / size, 0.0) / (max(size - 1, 1) * size)
        for sums, twos, size in ((added, squared, group.rows), (total - added, squares - squared, rest))
    ]
    scale = np.sqrt(variance[0] + variance[1])
    apart = sign * (added / group.rows - (total - added) / rest)
    with np.errstate(divide="ignore", invalid="ignore"):
        statistic = np.where(scale > 0, apart / scale, np.sign(apart) * inf)
    return int((statistic <= statistic[0] + 1e-9).sum()) / int(statistic.size)
