"""Student's t bounds on a mean and on a difference of means, for totals that are roughly normal.

With few episodes and skewed totals, they hold less often than stated. Only learning/bounds.py, which documents this,
may use them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import sqrt, tan
from statistics import NormalDist, fmean, variance

import numpy as np

FEW_DEGREES = 20  # below this many degrees of freedom, the density is integrated


def difference_bounds(first: Sequence[float], second: Sequence[float], risk: float) -> tuple[float, float]:
    """Return one-sided lower and upper bounds on mean(first) - mean(second), each at `risk` (Welch)."""
    unit = max(map(abs, (*first, *second))) or 1.0  # scaled so that squares do not overflow or underflow
    parts = [_spread([value / unit for value in group]) for group in (first, second)]
    spread = sqrt(sum(parts))
    freedom = [part**2 / max(len(group) - 1, 1) for part, group in zip(parts, (first, second), strict=True)]
    degrees = sum(parts) ** 2 / sum(freedom) if sum(freedom) > 0 else 1e9
    reach = student_quantile(1 - risk, degrees) * spread * unit
    difference = fmean(first) - fmean(second)
    return difference - reach, difference + reach


def mean_bounds(values: Sequence[float], confidence: float) -> tuple[float, float]:
    """Return the two-sided confidence interval for a mean (Student)."""
    reach = student_quantile((1 + confidence) / 2, max(len(values) - 1, 1)) * sqrt(_spread(values))
    return fmean(values) - reach, fmean(values) + reach


@lru_cache(maxsize=1024)  # the integral is slow, and a search uses few different ones
def student_quantile(probability: float, degrees: float) -> float:
    """Return a quantile of Student's t above the median.

    For many degrees of freedom, use expansion 26.7.5 of Abramowitz & Stegun. For few degrees of freedom, this expansion
    is far too low; instead, integrate the density over θ = atan(t / √degrees), which is proportional to cosᵈ⁻¹θ.
    """
    if degrees < FEW_DEGREES:
        angle = np.linspace(0.0, np.pi / 2, 20_001)
        density = np.cos(angle) ** (degrees - 1)
        below = np.append(0.0, np.cumsum(density[1:] + density[:-1]))
        reached = float(np.interp((2 * probability - 1) * below[-1], below, angle))
        return tan(reached) * sqrt(degrees)
    z = NormalDist().inv_cdf(probability)
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / degrees + second / degrees**2 + third / degrees**3


def _spread(values: Sequence[float]) -> float:
    return variance(values) / len(values) if len(values) > 1 else 0.0
