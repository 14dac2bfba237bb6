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
    shuffled = labels(pooled.size, online.size, generator, permutations) @ pooled
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
    statistic = np.abs(labels(columns.shape[0], first, generator, permutations) @ standard)
    order = np.argsort(statistic[0], kind="stable")
    largest = np.maximum.accumulate(statistic[:, order], axis=1)
    reached = (largest[1:] >= largest[0] - 1e-9).sum(axis=0)
    stepped = (1 + reached) / statistic.shape[0]
    p_values[alive[order]] = np.maximum.accumulate(stepped[::-1])[::-1]
    return p_values


def labels(rows: int, first: int, generator: np.random.Generator, permutations: int = PERMUTATIONS) -> Floats:
    """Return group indicators, shape (1 + permutations, rows): as observed, then shuffled."""
    drawn = np.argpartition(generator.random((permutations, rows)), first, axis=1)[:, :first]
    indicators = np.zeros((1 + permutations, rows))
    indicators[0, :first] = 1.0
    np.put_along_axis(indicators[1:], drawn, 1.0, axis=1)
    return indicators
