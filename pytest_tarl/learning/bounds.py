"""Compute bounds for future episodes of a world: success rate, mean and quantiles of the total reward, loss.

Every bound assumes that episodes are drawn independently from one world. The stated confidence is that of a single
bound. With several bounds, the probability that any of them is wrong is at most the sum of their risks. Further
assumptions:

    rate          nothing                                       exact (Clopper & Pearson 1934)
    mean_of       totals lie in a declared range                exact (betting; Waudby-Smith & Ramdas 2023, Theorem 3)
    mean_of       nothing declared                              approximate (Student): too high for skewed totals
    quantile_low  nothing                                       exact (order statistics)
    loss_between  both worlds' totals lie in a declared range   exact (two betting bounds)
    loss_between  nothing declared                              permutation: exact if the worlds differ by a shift;
                                                                approximate (Welch) if one of them varies more
    detectable    -                                             approximate (normal)

An acceptance test only needs to know whether a mean is above a limit; learning/betting.py tests this exactly. All
intervals and quantiles are computed in this module (tests/plugin/learning/test_bounds_are_one_place.py checks this). A
search uses approximate bounds only to choose and rank candidates, never for a guarantee.

"Exact" means at least the stated confidence, for any number of episodes that was fixed in advance. If the number
depends on the results, use `rate_sequence` or `mean_of` with `anytime`, which hold after every episode.
benchmarks/bound_coverage.py measures how often each bound holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
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

POWER = 0.8  # probability with which the smallest detectable loss is detected
STAKE = 0.75  # maximum share of the wealth to lose in one bet; the truncation c of Waudby-Smith & Ramdas


class Range(NamedTuple):
    """The declared limits of every episode's total reward."""

    low: float
    high: float


def rate(passed: int, episodes: int, confidence: float) -> Bound:
    """Return one-sided Clopper-Pearson bounds on a success rate, each at this confidence."""
    risk = 1.0 - confidence
    low = rate_low(passed, episodes, risk)
    high = 1.0 - rate_low(episodes - passed, episodes, risk)
    return Bound(low, high, confidence, "Clopper-Pearson", True, episodes)


@lru_cache(maxsize=4096)  # a stress search asks for the same few counts thousands of times
def rate_low(passed: int, episodes: int, risk: float) -> float:
    """Return the success rate for which `passed` or more passes have the probability `risk`."""
    if passed <= 0:
        return 0.0
    if passed == episodes:
        return float(risk ** (1.0 / episodes))
    tail = BinomialTail(passed - 1, episodes)
    return root(lambda p: 1.0 - tail(p) < risk, 0.0, passed / episodes)


def rate_sequence(passed: int, episodes: int, confidence: float) -> Bound:
    """Return one-sided bounds on a success rate that hold after every episode simultaneously."""
    risk = 1.0 - confidence
    low = _sequence_low(passed, episodes, risk)
    high = 1.0 - _sequence_low(episodes - passed, episodes, risk)
    return Bound(low, high, confidence, "confidence sequence", True, episodes)


def evidence_above(passed: int, episodes: int, least: float) -> float:
    """Return the log of an e-process against the claim that the success rate is at most `least`.

    An e-process measures evidence and may be read at any time. If the claim is true, the probability that its log ever
    exceeds log(1 / α) is at most α (Ville's inequality). This one averages the likelihood ratio uniformly over all
    higher rates (Robbins 1970).
    """
    failed = episodes - passed
    if least >= 1.0:
        return -inf
    if least <= 0.0:
        return 0.0
    # probability that a Beta(passed + 1, failed + 1) variable is above `least`
    above = BinomialTail(passed, episodes + 1)(least)
    if above <= 0.0:
        return -inf
    mixed = log(above) - log(episodes + 1) - log_choose(episodes)[passed] - log1p(-least)
    return float(mixed - passed * log(least) - failed * log1p(-least))


def mean_of(
    totals: Sequence[float], confidence: float, declared: Range | None = None, *, anytime: bool = False
) -> Bound:
    """Return one-sided bounds on a mean, each at this confidence; exact if the range is declared.

    With `anytime`, they hold after every episode simultaneously. A betting bound can exceed the observed mean if a bet
    won early; it is then clipped to the mean. Raise ValueError if a total is outside the range.
    """
    values = np.asarray(totals, dtype=np.float64)
    if declared is None:
        low, high = mean_bounds(values.tolist(), 2 * confidence - 1) if values.size > 1 else (-inf, inf)
        return Bound(low, high, confidence, "Student", False, values.size)
    width = declared.high - declared.low
    share = (values - declared.low) / width
    if share.size and not (share.min() >= 0.0 and share.max() <= 1.0):
        raise ValueError(f"a total lies outside {declared.low:g} to {declared.high:g}")
    risk = 1.0 - confidence
    low, high = (
        min(bet_low(one, risk, anytime=anytime), float(one.mean())) if one.size else 0.0
        for one in (share, 1.0 - share)
    )
    return Bound(
        declared.low + width * low, declared.high - width * high, confidence, "betting", True, values.size
    )


def bet_low(values: Floats, risk: float, *, anytime: bool = False) -> float:
    """Return a lower bound on the mean of `values` in [0, 1], shape (episodes,).

    For each candidate mean m, a bet stakes λ on values above m. If m is the true mean, the wealth of this bet is a
    martingale and rarely reaches 1 / risk. The bound is the largest m whose bet did reach it. λ depends only on earlier
    values. It is tuned for the given number of values or, with `anytime`, for any number.
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
    """Return a total that at least the share 1 - `share` of all episodes reaches; None if there are too few.

    The bound is the k-th smallest total for the largest k with P(Bin(n, share) < k) ≤ 1 - confidence.
    """
    ordered = sorted(totals)
    below = np.cumsum(probabilities(len(ordered), share))
    rank = int(np.searchsorted(below, 1.0 - confidence, side="right"))
    return ordered[rank - 1] if rank else None


def episodes_for_quantile(share: float, confidence: float) -> int:
    """Return how many episodes are needed for their lowest total to bound the quantile `share`."""
    return ceil(log(1.0 - confidence) / log1p(-share) - 1e-9)


def loss_between(
    offline: Sequence[float], online: Sequence[float], confidence: float, declared: Range | None = None
) -> Bound:
    """Return one-sided bounds on mean(offline) - mean(online), each at this confidence.

    Without a declared range, the result is the wider of two intervals:

    - The shifts that a studentised permutation test does not reject (Janssen 1997). This interval is exact if the
      totals of both worlds differ by a constant, even if they are skewed.
    - Welch's interval, for totals that are about normal and may vary more in one world.

    Raise ValueError if a total is outside the declared range.
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
    """Return the loss that a test at `risk` detects with probability POWER; inputs have shape (episodes,).

    This is a normal approximation. It is infinite if there are so few episodes, and thus permutations, that no loss can
    be significant.
    """
    if comb(offline.size + online.size, online.size) <= 1 / risk:  # integers, because a float would overflow
        return inf
    spread = np.sqrt(sum(one.var(ddof=1) / one.size for one in (offline, online) if one.size > 1))
    normal = NormalDist()
    return float((normal.inv_cdf(1 - risk) + normal.inv_cdf(POWER)) * spread)


def _sequence_low(passed: int, episodes: int, risk: float) -> float:
    if not passed:
        return 0.0
    return root(lambda p: evidence_above(passed, episodes, p) >= log(1.0 / risk), 0.0, passed / episodes)
