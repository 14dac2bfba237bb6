"""Conformal test martingales: test whether new missions are exchangeable with held-out recorded ones.

The pool starts with the scores of the held-out recorded missions, and every new mission joins it after its test.
So the smoothed rank of a new score in the pool is exactly uniform and independent of all earlier ranks, as long as the
missions are exchangeable (Vovk, Gammerman & Shafer 2005, theorem 8.1), for any number of recorded missions. A fixed
pool would not work: the chance composition of its few missions would accumulate as evidence.

Scores are rounded to bins, whose edges come from the other half of the recorded missions, so binning is a fixed
function of a score. The pool is then a row of counts: of fixed size for any number of missions, and exact, because ties
are broken at random. A bet is a non-negative function of the rank p with integral 1 over [0, 1].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats, Ints

BINS = 64
TAIL = 8  # bins beyond the fitted scores on either side, each twice as wide as the previous one
TOGETHER = 64  # missions ranked together; a multiple of 8 below 256
CLOSE = 1e-4  # share of a score's unit below which values count as equal


def edges(fitted: NDArray[np.float64], unit: float) -> Floats:
    """Return the edges of the bins, shape (BINS - 1,), from scores that are not in the pool.

    They lie midway between neighbouring values, so that no rounding of a value moves it into another bin. `unit` is
    the magnitude of the terms summed in these scores; bins with infinite edges stay empty.
    """
    unit = unit or 1.0
    values = np.unique(np.rint(fitted / (CLOSE * unit))) * (CLOSE * unit)
    if not values.size:
        values = np.zeros(1)
    between = (values[1:] + values[:-1]) / 2
    most = BINS - 1 - 2 * TAIL
    if between.size > most:
        ranked = np.quantile(fitted, np.arange(1, most + 1) / (most + 1))
        between = np.unique(between[np.searchsorted(between, ranked).clip(0, between.size - 1)])
    spread = float(values[-1] - values[0]) or unit
    away = spread * 2.0 ** np.arange(1 - TAIL, 1)
    found = np.concatenate((values[0] - away[::-1], between, values[-1] + away))
    return np.concatenate((found, np.full(BINS - 1 - found.size, np.inf)))


def ranks(pool: Ints, bins: Ints, draws: Floats) -> tuple[Floats, Floats]:
    """Return the smoothed ranks p and 1 - p of new scores, shape (missions, scores), both above 0.

    `pool` holds the counts before the first of these missions, shape (scores, BINS), `bins` those of the new scores, -1
    if a mission has none; each joins the pool after its ranking. `draws` are uniform on (0, 1], one per mission. At
    most TOGETHER missions.
    """
    has, score = bins >= 0, np.arange(bins.shape[1])
    before = np.cumsum(pool, axis=1)
    upto = before[score, bins]
    same, less = _earlier(np.where(has, bins, BINS))
    equal = pool[score, bins]
    number = before[:, -1] + np.cumsum(has, axis=0) - has
    equal, below = equal + same, upto - equal + less
    above = number - below - equal
    draw, everything = draws[:, None], number + 1.0
    low = (below + draw * (equal + 1)) / everything
    high = (above + (1.0 - draw + 2.0**-53) * (equal + 1)) / everything
    return np.where(has, low, 0.5), np.where(has, high, 0.5)


def _earlier(bins: Ints) -> tuple[Ints, Ints]:
    """Return the numbers of earlier missions with the same bin and with a smaller bin, for each mission and score."""
    count, scores = bins.shape
    mine = np.full((scores, TOGETHER), BINS, np.int8)
    mine[:, :count] = bins.T
    before = np.tri(count, TOGETHER, k=-1, dtype=bool)
    asked = mine[:, :count, None]
    return _counted((mine[:, None, :] == asked) & before), _counted((mine[:, None, :] < asked) & before)


def _counted(found: NDArray[np.bool_]) -> Ints:
    """Count true values along the last axis, transposed; adds eight bytes at a time, whose sums stay below 256."""
    words = found.view(np.uint64)
    total = words[..., 0].copy()
    for place in range(1, words.shape[-1]):
        total += words[..., place]
    return (total * np.uint64(0x0101010101010101) >> np.uint64(56)).astype(np.int64).T


def joined(pool: Ints, bins: Ints) -> Ints:
    """Return the pool, shape (scores, BINS), with the scores in `bins`, shape (missions, scores), added."""
    score = np.broadcast_to(np.arange(bins.shape[1]), bins.shape)
    has = bins >= 0
    added = np.bincount(score[has] * BINS + bins[has], minlength=pool.size)
    return pool + added.reshape(pool.shape)


def factors(low: Floats, high: Floats, found: Floats) -> None:
    """Write the factor on each bet's stake, shape (missions, bets, scores), from ranks of shape (missions, scores).

    εp^(ε-1) bets on small ranks, the same function of 1 - p on large ones, and of the distance to the nearer end on
    both; the lines 1 ± (1 - 2p)/2 bet on small shifts. Powers are computed with square roots, which round the same on
    all platforms.
    """
    for place, rank in ((0, low), (4, high)):
        root = np.sqrt(rank)
        fourth = np.sqrt(root)
        found[:, place] = 0.75 / fourth
        found[:, place + 1] = 0.5 / root
        found[:, place + 2] = 0.25 / (root * fourth)
        found[:, place + 3] = 0.125 / (root * fourth * np.sqrt(fourth))
    near = 2.0 * np.minimum(low, high)
    root = np.sqrt(near)
    found[:, 8] = 0.5 / root
    found[:, 9] = 0.25 / (root * np.sqrt(root))
    found[:, 10] = 1.5 - low
    found[:, 11] = 0.5 + low
