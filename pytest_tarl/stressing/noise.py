"""The noise of losses: how much losses vary apart from the effect of a drift."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from statistics import fmean, median

import numpy as np

from pytest_tarl.stressing.coordinates import Vector
from pytest_tarl.stressing.guarantee import LOWEST

HIGHEST = 1.0 - LOWEST  # larger losses count as this loss, because margins below LOWEST count as LOWEST
PRIOR = 4  # weight, in episodes, of the variance that is common to all drifts


def cut_off(losses: Sequence[float]) -> Vector:
    """Return losses, in units of the tolerated loss, limited to the range that the model distinguishes."""
    found: Vector = np.clip(np.array(losses), LOWEST, HIGHEST)
    return found


def typical_variance(every: Sequence[Vector]) -> float:
    """Return the mean variance of the losses of several drifts, with a cap so that noisy drifts do not dominate.

    The losses are cut off. A drift far beyond the boundary, where all of them are, does not count.
    """
    found = [float(np.var(one, ddof=1)) for one in every if len(one) > 1 and one.min() < HIGHEST]
    return max(fmean(min(one, 4.0 * median(found)) for one in found), 1e-6) if found else 1e-6


def standard_error(losses: Vector, typical: float) -> float:
    """Return the standard error of the mean of losses; their variance is shrunk towards the typical one."""
    count = len(losses)
    squares = float(np.var(losses)) * count
    return sqrt((squares + PRIOR * typical) / (count - 1 + PRIOR) / count)
