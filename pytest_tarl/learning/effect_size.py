"""The effect size of a difference of means."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan, sqrt
from statistics import fmean, variance


def effect_size(first: Sequence[float], second: Sequence[float]) -> float:
    """Return Hedges' g: mean(first) - mean(second) in pooled standard deviations; NaN if nothing varies."""
    degrees = len(first) + len(second) - 2
    squares = sum((len(group) - 1) * variance(group) for group in (first, second) if len(group) > 1)
    if degrees < 1 or squares <= 0:
        return nan
    correction = 1 - 3 / (4 * degrees - 1)
    return correction * (fmean(first) - fmean(second)) / sqrt(squares / degrees)
