"""Estimate how much losses vary for reasons other than the drift."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from statistics import fmean, median

import numpy as np

from pytest_tarl.stressing.coordinates import Vector
from pytest_tarl.stressing.guarantee import LOWEST, Guarantee

HIGHEST = 1.0 - LOWEST  # upper limit of losses, which corresponds to the lower limit LOWEST of margins
# width of the normal curve that weights drifts by the difference of their mean losses, in units of the tolerated loss
WIDTH = 0.3
# degrees of freedom that the typical variance counts for when it is averaged with those of similar drifts
LIKE = 2.0
# an unpaired test is preferred if its standard error is at most this many times that of the paired test
WORSE = 1.2
PRIOR = 4  # number of episodes that the typical variance of all drifts counts for


def cut_off(losses: Sequence[float]) -> Vector:
    """Return losses, in units of the tolerated loss, clipped to the range that the model distinguishes."""
    found: Vector = np.clip(np.array(losses), LOWEST, HIGHEST)
    return found


def typical_variance(every: Sequence[Vector]) -> float:
    """Return the mean variance of the losses of several drifts, capped against noisy drifts.

    Losses above HIGHEST count as HIGHEST. A drift whose losses are all above it lies far beyond the boundary and is
    ignored. The cap uses only drifts whose losses differ from each other, because at other drifts every episode may
    have the same reward.
    """
    found = [_squares(one) / (len(one) - 1) for one in every if _tells(one)]
    differ = [one for one in found if one > 0.0]
    return max(fmean(min(one, 4.0 * median(differ)) for one in found), 1e-6) if differ else 1e-6


def nominal_variance(given: Guarantee, typical: float) -> float:
    """Return the variance that a pair's nominal episode adds to a loss: at most half the typical variance.

    Two episodes with the same seed may have similar rewards, so the variance of the recorded rewards is only an upper
    limit.
    """
    if len(given.totals) < 2 or given.tolerance <= 0.0:
        return typical / 2.0
    return min(typical / 2.0, float(np.var(given.totals, ddof=1)) / given.tolerance**2)


def variance_near(loss: float, every: Sequence[Vector], typical: float) -> float:
    """Return the variance of the losses of drifts whose mean loss is about `loss`.

    Episodes often vary more at the boundary than near nominal. Each drift is weighted by its degrees of freedom and by
    how close its mean loss is to `loss`; the typical variance counts as `LIKE` degrees of freedom. Losses are clipped,
    and drifts far beyond the boundary are ignored.
    """
    known = [one for one in every if _tells(one)]
    if not known:
        return typical
    means = np.array([fmean(one.tolist()) for one in known])
    weights = np.exp(-(((means - loss) / WIDTH) ** 2) / 2.0)
    squares, free = np.array([_squares(one) for one in known]), np.array([len(one) - 1.0 for one in known])
    return float((weights @ squares + LIKE * typical) / (weights @ free + LIKE))


def pairing_wastes(
    given: Guarantee, paired: Sequence[Vector], unpaired: Sequence[Vector], episodes: int
) -> bool:
    """Return whether pairing with nominal episodes would hardly improve a test of this many episodes.

    Both arguments hold clipped losses in units of the tolerated loss: `paired` relative to the nominal episodes of the
    same seeds, `unpaired` relative to the mean of the nominal episodes. An unpaired test needs half as many episodes,
    but the recorded mean is uncertain.
    """
    if len(given.totals) < 2 or given.tolerance <= 0.0:
        return False
    apart, alone = (variance_near(1.0, every, typical_variance(every)) for every in (paired, unpaired))
    recorded = float(np.var(given.totals, ddof=1)) / given.tolerance**2 / len(given.totals)
    return sqrt(alone / episodes) + sqrt(recorded) <= WORSE * sqrt(apart / episodes)


def standard_error(losses: Vector, typical: float) -> float:
    """Return the standard error of the mean loss, with the variance shrunk towards the typical one."""
    count = len(losses)
    return sqrt((_squares(losses) + PRIOR * typical) / (count - 1 + PRIOR) / count)


def _tells(losses: Vector) -> bool:
    """Return whether the losses allow an estimate of the variance: two or more, and not all at the limit."""
    return len(losses) > 1 and min(losses.tolist()) < HIGHEST


def _squares(losses: Vector) -> float:
    """Return the sum of squared differences from the mean; faster than numpy for a few numbers."""
    values = losses.tolist()
    mean = sum(values) / len(values)
    return float(sum((one - mean) ** 2 for one in values))
