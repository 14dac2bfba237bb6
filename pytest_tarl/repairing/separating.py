"""Find the value of a threshold that separates the values of drifted missions as it separated the designed ones."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np

from pytest_tarl.instrumentation.trace import Floats

FEWEST = 4  # minimum number of values in each world
DIFFER = 0.1  # minimum difference between the shares of values above the threshold in the two worlds
MARGIN = 1.25  # a threshold beyond all values differs from the outermost value by this factor
GAP = 0.4  # minimum width of the gap between two groups of values, as a share of the range of all values


def separating(threshold: float, pairs: Sequence[tuple[Floats, Floats]]) -> float | None:
    """Return the factor that puts the same share of values above a threshold as designed; None if none is needed.

    `pairs` are the values of designed and drifted missions, of shape (values,) each. In each pair, the share must
    differ in the same direction. The new threshold lies halfway between two drifted values, on a log scale, or beyond
    all of them. Values whose sign differs from the threshold's sign are left out.
    """
    size, pairs = _sized(threshold, pairs)
    if not pairs or not all(one.size and other.size for one, other in pairs):
        return None
    changes = [_above(other, size) - _above(one, size) for one, other in pairs]
    if not (min(changes) >= DIFFER or max(changes) <= -DIFFER):
        return None
    before, after = (np.sort(np.concatenate(each)) for each in zip(*pairs, strict=True))
    if before.size < FEWEST or after.size < FEWEST:
        return None
    above = round(_above(before, size) * after.size)
    low = float(after[after.size - above - 1]) if above < after.size else float(after[0]) / MARGIN**2
    high = float(after[after.size - above]) if above else float(after[-1]) * MARGIN**2
    if low <= 0.0 or high <= low:
        return None
    return sqrt(low * high) / size


def between_groups(threshold: float, pairs: Sequence[tuple[Floats, Floats]]) -> float | None:
    """Return the factor that moves a threshold between the same groups as designed, or None.

    For example, the voltage of open contacts is near 21 V, and that of a charger near 28 V. If worn contacts leave only
    23 V of the 28 V, the threshold must lie between 21 and 23 V. A factor is returned only under these conditions:

    - In both worlds, the values form two groups.
    - The threshold is between the designed groups, but not between the drifted groups.
    - All values have the threshold's sign.
    """
    size, pairs = _sized(threshold, pairs)
    if not pairs:
        return None
    before, after = (np.sort(np.concatenate(each)) for each in zip(*pairs, strict=True))
    designed, drifted = _gap(before), _gap(after)
    if designed is None or drifted is None or drifted[0] <= 0.0:
        return None
    if not designed[0] < size < designed[1] or drifted[0] < size < drifted[1]:
        return None
    return (drifted[0] + drifted[1]) / 2.0 / size


def _gap(values: Floats) -> tuple[float, float] | None:
    """Return the ends of a clear gap between two groups of sorted values, or None."""
    if values.size < 2 * FEWEST:
        return None
    gaps = np.diff(values)
    at = int(np.argmax(gaps))
    few = min(at + 1, values.size - at - 1) < FEWEST
    if few or gaps[at] < GAP * (values[-1] - values[0]) or not gaps[at]:
        return None
    return float(values[at]), float(values[at + 1])


def reaching(threshold: float, pairs: Sequence[tuple[Floats, Floats]]) -> float | None:
    """Return the factor on a threshold that lets drifted missions cross it as designed missions do, or None.

    `pairs` are the values of designed and drifted missions, of shape (values,) each. In each pair, the designed values
    lie on both sides of the threshold, and the drifted values lie on one side only, which is the same side in all
    pairs. For example, a mobile base stops a little before its goal, and the error never falls below the tolerance. In
    each mission, take the drifted value that comes nearest to the threshold. The new threshold is `MARGIN` beyond the
    farthest of these values.
    """
    size, pairs = _sized(threshold, pairs)
    if not pairs or not all(one.size and other.size for one, other in pairs):
        return None
    if not all(0.0 < _above(one, size) < 1.0 for one, _ in pairs):
        return None
    drifted = [other for _, other in pairs]
    if all(float(one.min()) > size for one in drifted):
        return max(float(one.min()) for one in drifted) * MARGIN / size
    highest = min(float(one.max()) for one in drifted)
    if all(float(one.max()) <= size for one in drifted) and highest > 0.0:
        return highest / MARGIN / size
    return None


def _sized(
    threshold: float, pairs: Sequence[tuple[Floats, Floats]]
) -> tuple[float, Sequence[tuple[Floats, Floats]]]:
    """Return the threshold and the values. If the threshold is negative, flip the sign of all of them."""
    sign = 1.0 if threshold > 0.0 else -1.0
    return abs(threshold), [(sign * one, sign * other) for one, other in pairs]


def _above(values: Floats, size: float) -> float:
    return float(np.mean(values > size))
