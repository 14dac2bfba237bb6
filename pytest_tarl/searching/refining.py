"""Choose a constant's next factors, halfway (in log scale) between the best and its neighbours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise
from math import inf, sqrt

FURTHER = ((5.0, 2.2), (0.15, 0.4))  # pairs (larger step, smaller step that must not have reduced the reward)
# if the outermost factor is the best, the next factor is this many times larger (or smaller)
OUTWARD = 2.3
APART = 2.0  # if two factors have at least this ratio, a factor between them is tried even if neither gains
FINEST = 1.1  # no factor is tried between two factors whose ratio is below this
# a factor is refined down to the ratio `NARROWEST` only if it gains at least this share of the wanted gain
ALMOST = 0.9
FLAT = 2.0  # if two factors have equal gains and at most this ratio, no factor is tried between them
NARROWEST = 1.02  # smallest ratio between factors around a narrow peak
# a factor is promising if it gains at least this share of the wanted gain; a sharp peak (see SHARP) that exceeds 0 or a
# neighbour by this share is also refined down to `NARROWEST`
PROMISING = 0.4
SHARP = 0.5  # a peak is sharp if each neighbouring factor gains at most this share of the peak's gain


def bracket(by_factor: Mapping[float, float]) -> float:
    """Return the ratio of the two factors beside a sharp peak (see `SHARP`), or 1 if there is no sharp peak."""
    beside = _beside_peak(by_factor)
    if beside is None:
        return 1.0
    below, above = beside
    sharp = max(by_factor[below], by_factor[above]) <= SHARP * max(by_factor.values())
    return above / below if sharp else 1.0


def between_neighbours(by_factor: Mapping[float, float]) -> float:
    """Return the ratio of the two factors beside the best one, or 1 if one is missing or nothing gains."""
    beside = _beside_peak(by_factor)
    return beside[1] / beside[0] if beside is not None else 1.0


def _beside_peak(by_factor: Mapping[float, float]) -> tuple[float, float] | None:
    """Return the two factors beside the best factor, or None if one is missing or nothing gains."""
    factor = max(by_factor, key=by_factor.__getitem__)
    below, above = beside(factor, by_factor) if factor > 0.0 else (0.0, inf)
    return (below, above) if below > 0.0 and above < inf and by_factor[factor] > 0.0 else None


def beside(factor: float, tried: Iterable[float], outward: float = inf) -> tuple[float, float]:
    """Return the nearest positive tried factors below and above a positive factor.

    If no such factor was tried, return the one that is `outward` times smaller or larger (by default, 0 or infinity).
    """
    others = [one for one in tried if one > 0.0]
    below = max((one for one in others if one < factor), default=factor / outward)
    return below, min((one for one in others if one > factor), default=factor * outward)


def amid(by_factor: Mapping[float, float], slack: float) -> list[float]:
    """Return a factor between each two neighbours of which the inner one gains nothing and the outer one loses.

    The inner factor is the one nearer to 1, the old value. The old value itself does not count as a neighbour.
    Neighbours with a ratio below `APART` are skipped, because the first steps already lie between them.
    """
    found = []
    for outward in (
        sorted(one for one in by_factor if one > 1.0),
        sorted((f for f in by_factor if 0 < f < 1.0), reverse=True),
    ):
        for inner, outer in pairwise(outward):
            apart = max(inner, outer) >= APART * min(inner, outer)
            if apart and abs(by_factor[inner]) <= slack and by_factor[outer] < -slack:
                found.append(round(sqrt(inner * outer), 3))
    return found


def between(by_factor: Mapping[float, float], wanted: float) -> list[float]:
    """Return at most two factors to try next. They have the sign of the best factor.

    Return no factor if none gains. Return none either if both neighbours of the best factor are close to it and gain as
    much as it does, but too little. The cause is then elsewhere.

    `by_factor` maps each tried factor to its gain; `wanted` is the gain that restores the designed reward.
    """
    factor = max(by_factor, key=by_factor.__getitem__)
    sign = -1.0 if factor < 0 else 1.0
    gains = {abs(one): gain for one, gain in by_factor.items() if one * sign > 0}
    factor = abs(factor)
    if gains[factor] <= 0:
        return []
    neighbours = beside(factor, gains, OUTWARD**2)
    flat = all(one in gains and gains[one] == gains[factor] for one in neighbours)
    if flat and gains[factor] < ALMOST * wanted and neighbours[1] <= FLAT * neighbours[0]:
        return []
    finest = NARROWEST if _narrow(gains, factor, neighbours, wanted) else FINEST
    around = [one for one in neighbours if max(factor, one) > finest * min(factor, one)]
    return [sign * round(sqrt(factor * one), 3) for one in around]


def _narrow(
    gains: Mapping[float, float], factor: float, neighbours: tuple[float, float], wanted: float
) -> bool:
    """Return whether the range of good factors around `factor` may be narrower than the gap to its neighbours."""
    most = gains[factor]
    if most >= ALMOST * wanted:
        return True
    known = [gains[one] for one in neighbours if one in gains]
    sharp = len(known) == 2 and max(known) <= SHARP * most
    # a narrow range shows in a large gain, or in a reward that falls sharply between two close factors
    return sharp and most - min(0.0, *known) >= PROMISING * wanted
