"""Find the value of a threshold that separates the values of drifted missions as it separated the designed ones."""

from __future__ import annotations

from math import sqrt

import numpy as np

from pytest_tarl.instrumentation.trace import Floats

FEWEST = 4  # minimum number of values in each world
DIFFER = 0.1  # minimum difference between the shares of values above the threshold in the two worlds
MARGIN = 1.25  # factor from the outermost value to a threshold beyond it


def separating(threshold: float, designed: Floats, drifted: Floats) -> float | None:
    """Return the factor of a threshold that leaves the designed share of values above it, or None if it does already.

    The new threshold lies halfway between two drifted values, on a log scale, or beyond all of them. Values whose sign
    differs from that of the threshold say nothing about its size.
    """
    sign = 1.0 if threshold > 0.0 else -1.0
    before, after = (np.sort(sign * one) for one in (designed, drifted))
    if before.size < FEWEST or after.size < FEWEST:
        return None
    size = abs(threshold)
    share, now = float(np.mean(before > size)), float(np.mean(after > size))
    if abs(share - now) < DIFFER:
        return None
    above = round(share * after.size)
    low = float(after[after.size - above - 1]) if above < after.size else float(after[0]) / MARGIN**2
    high = float(after[after.size - above]) if above else float(after[-1]) * MARGIN**2
    if low <= 0.0 or high <= low:
        return None
    return sqrt(low * high) / size
