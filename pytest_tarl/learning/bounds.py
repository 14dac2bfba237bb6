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
    detectable    -                                             approximate (normal): what a test would have seen

An acceptance asks whether a mean is above a limit, for values that have a lower end only: learning/betting.py, exact.
No other module computes an interval or a quantile of its own (tests/plugin/learning/test_bounds_are_one_place.py).
What a search decides by an approximate bound is where to look next and what to say first, never what to promise.

"Exact" means at least the stated confidence, for any number of episodes that was fixed beforehand. Where it was not,
because recording went on until something was settled, `rate_sequence`, and `mean_of` with `anytime`, hold at all times.
benchmarks/bound_coverage.py measures how often each of them holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, comb, inf, log, log1p
from statistics import NormalDist
from typing import NamedTuple

import numpy as np

from pytest_tarl.learning.binomial import BinomialTail, log_choose, probabilities
from pytest_tarl.learning.roots import root
from pytest_tarl.learning.shifts import shifts
from pytest_tarl.learning.student import difference_bounds, mean_bounds
from pytest_tarl.learning.tables import Floats
from pytest_tarl.model import Bound

POWER = 0.8  # of the smallest loss that is called detectable
STAKE = 0.75  # of what a bet may lose at once: the truncation c of Waudby-Smith & Ramdas


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
    return root(lambda p: 1.0 - tail(p) < risk, 0.0, passed / episodes)


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
    mixed = log(above) - log(episodes + 1) - log_choose(episodes)[passed] - log1p(-least)
    return float(mixed - passed * log(least) - failed * log1p(-least))


def mean_of(
    totals: Sequence[float], confidence: float, declared: Range | None = None, *, anytime: bool = False
) -> Bound:
    """Return the one-sided bounds of a mean, each at the confidence; exact where the range is declared.

    With `anytime` they hold after every episode at once. A bet that was won early stays won, so a bound may pass the
    mean of what was seen; there it ends. Raises ValueError where a total lies outside of the range.
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
    low, high = (
        min(bet_low(one, risk, anytime=anytime), float(one.mean())) if one.size else 0.0
        for one in (share, 1.0 - share)
    )
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

    return root(refuted, 0.0, 1.0)


def quantile_low(totals: Sequence[float], share: float, confidence: float) -> float | None:
    """Return a total that at least 1 - `share` of all episodes reach; None where there are too few episodes.

    That is the largest order statistic k with P(Bin(n, share) < k) ≤ 1 - confidence.
    """
    ordered = sorted(totals)
    below = np.cumsum(probabilities(len(ordered), share))
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
        apart = shifts(np.asarray(offline, float), np.asarray(online, float), 1.0 - confidence)
        low, high = difference_bounds(offline, online, 1.0 - confidence)
        return Bound(min(low, apart[0]), max(high, apart[1]), confidence, "permutation", False, episodes)
    half = 1.0 - (1.0 - confidence) / 2
    before, after = mean_of(offline, half, declared), mean_of(online, half, declared)
    return Bound(before.low - after.high, before.high - after.low, confidence, "betting", True, episodes)


def detectable_loss(offline: Floats, online: Floats, risk: float) -> float:
    """Return the loss that a test of this size at `risk` would have seen four times in five, by normal approximation.

    Infinite where so few episodes can be shuffled in so few ways that no loss is significant.
    """
    if risk * comb(offline.size + online.size, online.size) <= 1:
        return inf
    spread = np.sqrt(sum(one.var(ddof=1) / one.size for one in (offline, online) if one.size > 1))
    normal = NormalDist()
    return float((normal.inv_cdf(1 - risk) + normal.inv_cdf(POWER)) * spread)


def _sequence_low(passed: int, episodes: int, risk: float) -> float:
    if not passed:
        return 0.0
    return root(lambda p: evidence_above(passed, episodes, p) >= log(1.0 / risk), 0.0, passed / episodes)
