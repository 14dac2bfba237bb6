"""Bounds on what a world's next episodes do: success rate, mean and quantiles of the total reward, loss.

Each one assumes that episodes are drawn independently from one world, and holds by itself (marginally): several of them
hold together at the sum of their risks. What else they assume:

    rate          nothing                                       exact (Clopper & Pearson 1934)
    mean_of       totals lie in a declared range                exact (betting; Waudby-Smith & Ramdas 2023, Theorem 3)
    mean_of       nothing declared                              approximate (Student): too high for skewed totals
    quantile_low  nothing                                       exact (order statistics)
    loss_between  both worlds' totals lie in a declared range   exact (two betting bounds)
    loss_between  nothing declared                              permutation: exact if the worlds differ by a shift;
                                                                approximate (Welch) if one of them varies more

"Exact" means at least the stated confidence, for any number of episodes that was fixed beforehand. Where it was not,
because recording went on until something was settled, `rate_sequence`, and `mean_of` with `anytime`, hold at all times.
benchmarks/bound_coverage.py measures how often each of them holds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import ceil, exp, inf, log, log1p
from typing import NamedTuple

import numpy as np

from pytest_tarl.learning.intervals import difference_bounds, mean_bounds
from pytest_tarl.learning.permutation import ARITHMETIC
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.model import Bound
from pytest_tarl.seeds import generator

HALVINGS = 60  # of an interval that holds a root: its width is then that of a float
COARSE = 30  # halvings where the root is one of shuffles, which are known less well
STAKE = 0.75  # of what a bet may lose at once: the truncation c of Waudby-Smith & Ramdas
LEAST_PERMUTATIONS = 999
PER_RISK = 20  # permutations beyond a p-value at the risk that is asked for
MOST_PERMUTATIONS = 40_000
AT_ONCE = 2_000  # shuffles that are drawn together: a few MB


class Range(NamedTuple):
    """Between which values every episode's total lies, whatever happens."""

    low: float
    high: float


def rate(passed: int, episodes: int, confidence: float) -> Bound:
    """Return the one-sided bounds of a success rate, each at the confidence (Clopper & Pearson)."""
    risk = 1.0 - confidence
    low = rate_low(passed, episodes, risk)
    high = 1.0 - rate_low(episodes - passed, episodes, risk)
    return Bound(low, high, confidence, "Clopper-Pearson", True, episodes)


def rate_low(passed: int, episodes: int, risk: float) -> float:
    """Return the rate below which so many passes or more have at most the probability `risk`."""
    if passed <= 0:
        return 0.0
    if passed == episodes:
        return float(risk ** (1.0 / episodes))
    tail = BinomialTail(passed - 1, episodes)
    return _root(lambda p: 1.0 - tail(p) < risk, 0.0, passed / episodes)


def rate_sequence(passed: int, episodes: int, confidence: float) -> Bound:
    """Return one-sided bounds of a success rate that hold after every episode at once, however often one looks."""
    risk = 1.0 - confidence
    low = _sequence_low(passed, episodes, risk)
    high = 1.0 - _sequence_low(episodes - passed, episodes, risk)
    return Bound(low, high, confidence, "confidence sequence", True, episodes)


def evidence_above(passed: int, episodes: int, least: float) -> float:
    """Return the log of an e-process against a success rate of `least` or less: it rarely grows where that is so.

    The likelihood ratio is mixed over all higher rates, uniformly (Robbins 1970); it exceeds log(1 / α) ever with
    probability α at most (Ville).
    """
    failed = episodes - passed
    if least >= 1.0:
        return -inf
    if least <= 0.0:
        return 0.0
    above = BinomialTail(passed, episodes + 1)(
        least
    )  # of a Beta(passed + 1, failed + 1), the share above `least`
    if above <= 0.0:
        return -inf
    mixed = log(above) - log(episodes + 1) - _log_choose(episodes)[passed] - log1p(-least)
    return float(mixed - passed * log(least) - failed * log1p(-least))


def mean_of(
    totals: Sequence[float], confidence: float, declared: Range | None = None, *, anytime: bool = False
) -> Bound:
    """Return the one-sided bounds of a mean, each at the confidence; exact where the range is declared.

    With `anytime` they hold after every episode at once. Raises ValueError where a total lies outside of the range.
    """
    values = np.asarray(totals, dtype=np.float64)
    if declared is None:
        low, high = mean_bounds(values.tolist(), 2 * confidence - 1) if values.size > 1 else (-inf, inf)
        return Bound(low, high, confidence, "Student", False, values.size)
    width = declared.high - declared.low
    share = (values - declared.low) / width
    if share.size and not (share.min() >= 0.0 and share.max() <= 1.0):
        raise ValueError(f"a total lies outside of {declared.low:g} to {declared.high:g}")
    risk = 1.0 - confidence
    low, high = (bet_low(one, risk, anytime=anytime) for one in (share, 1.0 - share))
    return Bound(
        declared.low + width * low, declared.high - width * high, confidence, "betting", True, values.size
    )


def bet_low(values: Floats, risk: float, *, anytime: bool = False) -> float:
    """Return the mean, of values from 0 to 1, below which a gambler would have multiplied his money by 1 / risk.

    He bets that values exceed m, λ of them at a time; where the mean is m his money is a martingale. λ is chosen from
    the values before, for so many values as there are, or with `anytime` for any number of them.
    """
    if not values.size:
        return 0.0
    count = np.arange(1, values.size + 1)
    mean = (0.5 + np.cumsum(values)) / (count + 1)
    variance = (0.25 + np.cumsum((values - mean) ** 2)) / (count + 1)
    before = np.append(0.25, variance[:-1])
    horizon = count * np.log(count + 1) if anytime else np.full(count.size, float(count.size))
    stake = np.sqrt(2.0 * log(1.0 / risk) / (before * horizon))

    def refuted(m: float) -> bool:
        money = np.cumsum(np.log1p(np.minimum(stake, STAKE / m) * (values - m)))
        return bool(money.max() >= log(1.0 / risk))

    return _root(refuted, 0.0, 1.0)


def quantile_low(totals: Sequence[float], share: float, confidence: float) -> float | None:
    """Return a total that at least 1 - `share` of all episodes reach; None where there are too few episodes.

    That is the largest order statistic k with P(Bin(n, share) < k) ≤ 1 - confidence.
    """
    ordered = sorted(totals)
    below = np.cumsum(_binomial(len(ordered), share))
    rank = int(np.searchsorted(below, 1.0 - confidence, side="right"))
    return ordered[rank - 1] if rank else None


def episodes_for_quantile(share: float, confidence: float) -> int:
    """Return how many episodes it takes until the lowest of them bounds that quantile."""
    return ceil(log(1.0 - confidence) / log1p(-share) - 1e-9)


def loss_between(
    offline: Sequence[float], online: Sequence[float], confidence: float, declared: Range | None = None
) -> Bound:
    """Return the one-sided bounds of mean(offline) - mean(online), each at the confidence.

    Without a declared range they are the wider ones of two: the shifts that a studentised permutation test does not
    refute (Janssen 1997), exact where on-line totals are off-line ones and a constant, however skewed; and Welch's,
    which hold for totals that are about normal and vary more in one world.
    """
    episodes = min(len(offline), len(online))
    if declared is None:
        if episodes < 2:
            return Bound(-inf, inf, confidence, "permutation", False, episodes)
        shifts = _shifts(np.asarray(offline, float), np.asarray(online, float), 1.0 - confidence)
        low, high = difference_bounds(offline, online, 1.0 - confidence)
        return Bound(min(low, shifts[0]), max(high, shifts[1]), confidence, "permutation", False, episodes)
    half = 1.0 - (1.0 - confidence) / 2
    before, after = mean_of(offline, half, declared), mean_of(online, half, declared)
    return Bound(before.low - after.high, before.high - after.low, confidence, "betting", True, episodes)


class BinomialTail:
    """P(Bin(n, p) ≤ k) as a function of p, by its exact sum."""

    def __init__(self, k: int, n: int) -> None:
        self._reached = np.arange(k + 1)
        self._rest = n - self._reached
        self._ways = _log_choose(n)[: k + 1]

    def __call__(self, p: float) -> float:
        """Return the probability."""
        if p <= 0.0 or not self._reached.size:
            return 1.0 if self._reached.size else 0.0
        if p >= 1.0:
            return 1.0 if self._rest[-1] <= 0 else 0.0
        terms = self._ways + self._reached * log(p) + self._rest * log1p(-p)
        largest = float(terms.max())
        return min(1.0, exp(largest) * float(np.exp(terms - largest).sum()))


def _binomial(n: int, p: float) -> Floats:
    """Return the probabilities of 0 to n, shape (n + 1,)."""
    reached = np.arange(n + 1)
    found: Floats = np.exp(_log_choose(n) + reached * log(p) + (n - reached) * log1p(-p))
    return found


def _log_choose(n: int) -> Floats:
    """Return log C(n, k) for k from 0 to n, shape (n + 1,)."""
    k = np.arange(1, n + 1)
    return np.append(0.0, np.cumsum(np.log((n - k + 1) / k)))


def _root(refuted: Callable[[float], bool], low: float, high: float, halvings: int = HALVINGS) -> float:
    """Return the largest value that is refuted, where all below it are; `low` where none is."""
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (middle, high) if refuted(middle) else (low, middle)
    return low


def _sequence_low(passed: int, episodes: int, risk: float) -> float:
    if not passed:
        return 0.0
    return _root(lambda p: evidence_above(passed, episodes, p) >= log(1.0 / risk), 0.0, passed / episodes)


def _shifts(offline: Floats, online: Floats, risk: float) -> tuple[float, float]:
    """Return the least and the largest shift between the groups that a permutation test at `risk` leaves possible."""
    difference = float(offline.mean() - online.mean())
    unit = float(np.ptp(offline) + np.ptp(online))  # further apart, the groups would not overlap
    if unit <= ARITHMETIC * float(np.abs(np.concatenate((offline, online))).max()):
        return difference - unit, difference + unit
    before, after = (offline - offline.mean()) / unit, (online - online.mean()) / unit
    shuffles = min(max(LEAST_PERMUTATIONS, ceil(PER_RISK / risk)), MOST_PERMUTATIONS)
    drawn = _drawn(offline.size + online.size, online.size, shuffles)

    def refuted(shift: float, sign: float) -> bool:
        """Tell whether the on-line group, moved so far from the same mean, is too low (or too high) for one world."""
        pooled = sign * np.concatenate((after + shift, before))
        return _studentised_p(pooled - pooled.mean(), online.size, drawn) <= risk

    if not refuted(-1.0, 1.0) or not refuted(1.0, -1.0):
        return -inf, inf  # so few episodes can be shuffled in too few ways
    low = _root(lambda by: refuted(by - 1.0, 1.0), 0.0, 1.0, COARSE) - 1.0
    high = 1.0 - _root(lambda by: refuted(1.0 - by, -1.0), 0.0, 1.0, COARSE)
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
