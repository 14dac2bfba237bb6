"""Conformal test martingales: test whether new missions are exchangeable with held-out recorded ones.

The pool starts with the scores of the held-out recorded missions. Each new mission is ranked in the pool and then added
to it. As long as missions are exchangeable, the smoothed rank of a new score is exactly uniform and independent of all
earlier ranks, for any number of recorded missions (Vovk, Gammerman & Shafer 2005, theorem 8.1). A fixed pool would not
work: it has few missions, and their peculiarities would accumulate as evidence.

Scores are rounded to bins. The bin edges come from the other half of the recorded missions, so the bin is a fixed
function of the score. The pool is a row of counts, whose size does not grow with the number of missions. Ties are
broken at random to keep the test exact. A bet is a non-negative function of the rank p with integral 1 over [0, 1].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Floats, Ints

BINS = 64
# number of bins beyond the fitted scores at each end; each is twice as wide as its inner neighbour
TAIL = 8
TOGETHER = 64  # number of missions ranked together; a multiple of 8 below 256, see `_counted`
CLOSE = 1e-4  # values that differ by less than this share of a score's unit count as equal


def edges(fitted: NDArray[np.float64], unit: float) -> Floats:
    """Return the bin edges, shape (BINS - 1,), from the fitted scores, which are not in the pool.

    Edges lie midway between neighbouring values, so rounding errors do not move a value into another bin. A score is a
    sum; `unit` is the magnitude of its terms. Unused bins have infinite edges and stay empty.
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
    """Return the smoothed ranks p and 1 - p of new scores, shape (missions, scores); both are above 0.

    - `pool`: counts before the first of these missions, shape (scores, BINS)
    - `bins`: bins of the new scores; -1 where a mission lacks a score
    - `draws`: uniform numbers on (0, 1], one per mission

    Each mission joins the pool after it is ranked. There may be at most TOGETHER missions.
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
    """Count the earlier missions in the same bin, and those in smaller bins."""
    count, scores = bins.shape
    mine = np.full((scores, TOGETHER), BINS, np.int8)
    mine[:, :count] = bins.T
    before = np.tri(count, TOGETHER, k=-1, dtype=bool)
    asked = mine[:, :count, None]
    return _counted((mine[:, None, :] == asked) & before), _counted((mine[:, None, :] < asked) & before)


def _counted(found: NDArray[np.bool_]) -> Ints:
    """Count true values along the last axis, and transpose.

    Eight bytes are added at a time; their sums stay below 256 and cannot overflow.
    """
    words = found.view(np.uint64)
    total = words[..., 0].copy()
    for place in range(1, words.shape[-1]):
        total += words[..., place]
    return (total * np.uint64(0x0101010101010101) >> np.uint64(56)).astype(np.int64).T


def joined(pool: Ints, bins: Ints) -> Ints:
    """Return the pool (scores, BINS) with the `bins` (missions, scores) added."""
    score = np.broadcast_to(np.arange(bins.shape[1]), bins.shape)
    has = bins >= 0
    added = np.bincount(score[has] * BINS + bins[has], minlength=pool.size)
    return pool + added.reshape(pool.shape)


def factors(low: Floats, high: Floats, found: Floats) -> None:
    """Write to `found` each bet's factor for its stake, shape (missions, bets, scores).

    `low` and `high` are the ranks p and 1 - p, shape (missions, scores). Bets of the form εq^(ε-1) win if q is small:

    - q = p wins on small ranks.
    - q = 1 - p wins on large ranks.
    - q = twice the distance from p to the nearer end of [0, 1] wins on both.

    Bets of the form 1 ± (1 - 2p)/2 win on small shifts. Powers are computed with square roots, which round equally on
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
