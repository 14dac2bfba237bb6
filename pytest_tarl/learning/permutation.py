"""Permutation tests of the hypothesis that two groups of episodes are exchangeable.

A test uses all groups if there are at most as many as the requested shuffles, so that a small sample can reach its
smallest possible p-value. Otherwise it uses random groups.

P-values are corrected over many columns by the distribution of the largest statistic, step by step (Westfall & Young
1993).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil, comb

import numpy as np

from pytest_tarl.learning.enumeration import enumerable, other_groups
from pytest_tarl.learning.tables import Floats, Ints

PERMUTATIONS = 999
MOST_PERMUTATIONS = 19_999
ARITHMETIC = 1e-12  # rounding error of a few float sums, relative to the largest
# p-values of at least this size get no further shuffles
SETTLED = 0.2
AT_ONCE = 64  # number of shuffles drawn at once, chosen to fit into the processor's cache


def permutations_for(alpha: float, comparisons: int) -> int:
    """Return how many shuffles are needed for a result to be significant after correction."""
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

    Sums that differ only by rounding count as equal, which makes the p-value larger. All shuffles are used only if the
    p-value may be below SETTLED.
    """
    pooled = np.concatenate((online, offline))
    rounding = ARITHMETIC * float(np.abs(pooled).sum())
    pooled -= pooled.mean()
    tie = 1e-9 * float(np.abs(pooled).sum()) + rounding  # rounding depends on the order of summation
    observed = observed_sum(pooled, online.size) + tie

    def reached(shuffled: Floats) -> Ints:
        return np.count_nonzero(shuffled <= observed, axis=0, keepdims=True)

    return float(_p_values(reached, pooled, online.size, generator, permutations)[0])


def permuted_decreases(
    offline: Floats, online: Floats, generator: np.random.Generator, permutations: int = PERMUTATIONS
) -> Floats:
    """Return each column's one-sided p-value for a lower deployed mean, corrected over all columns.

    Inputs have shape (episodes, columns). A constant column does not affect the others.
    """
    varied = np.flatnonzero(np.ptp(np.concatenate((online, offline)), axis=0) > 0)
    p_values = np.ones(online.shape[1])
    if varied.size == 1:
        one = varied[0]
        p_values[one] = permuted_loss(offline[:, one], online[:, one], generator, permutations)
    elif varied.size:
        columns = -np.concatenate((online, offline))
        p_values = max_statistic(columns, len(online), generator, permutations, one_sided=True)
    return p_values


def max_statistic(
    columns: Floats,
    first: int,
    generator: np.random.Generator,
    permutations: int = PERMUTATIONS,
    error: float = ARITHMETIC,
    *,
    one_sided: bool = False,
) -> Floats:
    """Return the p-value of each column, corrected over all columns; shape (columns,).

    The first `first` rows form one group, all other rows the second. The statistic is the difference of the group means
    in standard deviations of the column; it orders columns as the pooled t statistic does. If `one_sided`, only larger
    values in the first group count. Each column is compared with the maximum over itself and all columns with smaller
    statistics (step-down). A column that varies by at most the share `error` of its largest entry counts as constant
    and gets the p-value 1.
    """
    size = (lambda sums: sums) if one_sided else np.abs
    deviation = columns - columns.mean(axis=0)
    extent, largest = (np.abs(part).max(axis=0, initial=0.0) for part in (deviation, columns))
    alive = np.flatnonzero(extent > error * largest)
    p_values = np.ones(columns.shape[1])
    if not alive.size or not 0 < first < columns.shape[0]:
        return p_values
    relative = deviation[:, alive] / extent[alive]  # scaled so that squares do not overflow or underflow
    standard = relative / np.sqrt((relative**2).mean(axis=0))
    observed = size(observed_sum(standard, first))
    order = np.argsort(observed, kind="stable")
    limit = np.maximum.accumulate(observed[order]) - 1e-9

    def reached(shuffled: Floats) -> Ints:
        largest = np.maximum.accumulate(size(shuffled)[:, order], axis=1)
        return np.asarray(np.count_nonzero(largest >= limit, axis=0))

    stepped = _p_values(reached, standard, first, generator, permutations)
    p_values[alive[order]] = np.maximum.accumulate(stepped[::-1])[::-1]
    return p_values


def _p_values(
    reached: Callable[[Floats], Ints],
    values: Floats,
    first: int,
    generator: np.random.Generator,
    permutations: int,
) -> Floats:
    """Return one-sided p-values, shape (counts,).

    `reached` gets the sums of some shuffles. For each statistic, it returns how many of these shuffles reach the
    observed value.

    More than PERMUTATIONS shuffles are needed only for p-values that may stay significant after a correction over many
    comparisons. If the smallest p-value is at least SETTLED after PERMUTATIONS shuffles, the rest are skipped. This
    never gives a p-value below SETTLED.
    """
    counts, done = None, 0
    for shuffled in shuffled_sums(values, first, generator, permutations):
        more = reached(shuffled)
        counts = more if counts is None else counts + more
        done += len(shuffled)
        if done >= PERMUTATIONS and (1 + counts.min()) / (1 + done) >= SETTLED:
            break
    return np.ones(1) if counts is None else (1 + counts) / (1 + done)


def observed_sum(values: Floats, first: int) -> Floats:
    """Sum the first `first` rows of `values`, shape (rows, ...); the result has shape (...)."""
    picked = np.zeros((1, len(values)))
    picked[0, :first] = 1.0
    return np.asarray((picked @ values)[0])


def shuffled_sums(
    values: Floats, first: int, generator: np.random.Generator, permutations: int = PERMUTATIONS
) -> Iterator[Floats]:
    """Yield the sums of groups of `first` rows, several groups at a time, shape (groups, ...).

    `values` has shape (rows, ...); its first rows are the observed group. If there are at most `permutations` other
    groups, each is used once. Otherwise each shuffle draws a random number per row and picks the rows with the smallest
    numbers.
    """
    if enumerable(len(values), first, permutations):
        groups = other_groups(len(values), first)
        for done in range(0, len(groups), AT_ONCE):
            yield _picked(groups[done : done + AT_ONCE], len(values)) @ values
        return
    for done in range(0, permutations, AT_ONCE):
        draws = generator.random((min(AT_ONCE, permutations - done), len(values)))
        yield _smallest(draws, first) @ values


def _picked(groups: Ints, rows: int) -> Floats:
    """Return a matrix of shape (groups, rows), 1 where a row belongs to a group and 0 elsewhere."""
    picked = np.zeros((len(groups), rows))
    np.put_along_axis(picked, groups, 1.0, axis=1)
    return picked


def _smallest(draws: Floats, first: int) -> Floats:
    """Mark the `first` smallest numbers in each row with 1 and all others with 0; keep the shape."""
    limit = np.partition(draws, first, axis=1)[:, first, None]
    picked = (draws < limit).astype(np.float64)
    # rows with several numbers at the limit: fewer than `first` numbers are below it
    tied = np.flatnonzero(picked.sum(axis=1) != first)
    for row in tied.tolist():
        picked[row, np.argpartition(draws[row], first)[:first]] = 1.0
    return picked
