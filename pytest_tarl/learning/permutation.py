"""Permutation tests under the hypothesis that both groups of episodes are exchangeable.

Corrected over many columns by the distribution of the largest statistic, step by step (Westfall & Young 1993).
"""

from __future__ import annotations

from math import ceil, comb

import numpy as np

from pytest_tarl.learning.tables import Floats

PERMUTATIONS = 999
MOST_PERMUTATIONS = 19_999
ARITHMETIC = 1e-12  # error of a few sums of floats, relative to the largest of them
AT_ONCE = 64  # shuffles drawn together, so that they stay in the processor's cache


def permutations_for(alpha: float, comparisons: int) -> int:
    """Return the number of shuffles at which a result can be significant after correcting for the comparisons."""
    return (
        min(max(PERMUTATIONS, ceil(2 * comparisons / alpha) - 1), MOST_PERMUTATIONS)
        if comparisons > 1
        else PERMUTATIONS
    )


def least_p_value(offline: int, online: int, permutations: int) -> float:
    """Return the smallest possible p-value for these numbers of episodes and shuffles."""
    return max(1 / (1 + permutations), 1 / comb(offline + online, online))


def permuted_loss(
    offline: Floats, online: Floats, generator: np.random.Generator, permutations: int = PERMUTATIONS
) -> float:
    """Return the one-sided permutation p-value for a lower deployed mean; inputs have shape (episodes,).

    Sums that differ by at most rounding errors are ties, and count against a loss.
    """
    pooled = np.concatenate((online, offline))
    rounding = ARITHMETIC * float(np.abs(pooled).sum())
    pooled -= pooled.mean()
    shuffled = shuffled_sums(pooled, online.size, generator, permutations)
    tie = 1e-9 * float(np.abs(pooled).sum()) + rounding  # the order of a sum changes its rounding
    return (1 + int(np.count_nonzero(shuffled[1:] <= shuffled[0] + tie))) / shuffled.size


def max_statistic(
    columns: Floats,
    first: int,
    generator: np.random.Generator,
    permutations: int = PERMUTATIONS,
    error: float = ARITHMETIC,
) -> Floats:
    """Return each column's p-value corrected over all columns, shape (columns,).

    The first `first` rows form one group, the rest the other. The statistic is the difference of the groups' means in
    units of the column's standard deviation, which orders columns as the pooled t statistic does. A column is compared
    with the maximum over the columns that do not differ more (step-down). A column counts as constant if it
    varies by at most `error` of its largest entry.
    """
    deviation = columns - columns.mean(axis=0)
    extent, largest = (np.abs(part).max(axis=0, initial=0.0) for part in (deviation, columns))
    alive = np.flatnonzero(extent > error * largest)
    p_values = np.ones(columns.shape[1])
    if not alive.size or not 0 < first < columns.shape[0]:
        return p_values
    relative = deviation[:, alive] / extent[alive]  # scaled, so that squares neither overflow nor underflow
    standard = relative / np.sqrt((relative**2).mean(axis=0))
    statistic = np.abs(shuffled_sums(standard, first, generator, permutations))
    order = np.argsort(statistic[0], kind="stable")
    largest = np.maximum.accumulate(statistic[:, order], axis=1)
    reached = (largest[1:] >= largest[0] - 1e-9).sum(axis=0)
    stepped = (1 + reached) / statistic.shape[0]
    p_values[alive[order]] = np.maximum.accumulate(stepped[::-1])[::-1]
    return p_values


def shuffled_sums(
    values: Floats, first: int, generator: np.random.Generator, permutations: int = PERMUTATIONS
) -> Floats:
    """Return the sums over a group of `first` rows, shape (1 + permutations, ...): the first rows, then random ones.

    `values` have shape (rows, ...). A shuffle draws a number for each row and picks the rows with the smallest.
    """
    rows = len(values)
    observed = np.zeros((1, rows))
    observed[0, :first] = 1.0
    sums = [observed @ values]
    for done in range(0, permutations, AT_ONCE):
        draws = generator.random((min(AT_ONCE, permutations - done), rows))
        sums.append(_smallest(draws, first) @ values)
    return np.concatenate(sums)


def _smallest(draws: Floats, first: int) -> Floats:
    """Return 1 for the `first` smallest numbers of each row, else 0; same shape."""
    limit = np.partition(draws, first, axis=1)[:, first, None]
    picked = (draws < limit).astype(np.float64)
    tied = np.flatnonzero(picked.sum(axis=1) != first)  # equal numbers at the limit
    for row in tied.tolist():
        picked[row] = 0.0
        picked[row, np.argpartition(draws[row], first)[:first]] = 1.0
    return picked
