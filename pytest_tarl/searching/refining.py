"""Choose the next factors of one constant: halfway between its best factor and the neighbours, on a log scale."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from math import sqrt

FURTHER = ((5.0, 2.2), (0.15, 0.4))  # (larger step, smaller step that must not have reduced the reward)
# ratio of the next factor to the outermost one (or the reverse), if the outermost factor is the best
OUTWARD = 2.3
APART = 2.0  # a factor between two factors is tried although neither gains if their ratio is at least this
FINEST = 1.1  # no factor is tried between two factors whose ratio is below this
# minimum gain of a factor that is refined down to the ratio `NARROWEST`, as a share of the wanted gain
ALMOST = 0.9
FLAT = 2.0  # no factor is tried between two factors with equal gains if their ratio is at most this
NARROWEST = 1.02  # smallest ratio between factors around a narrow peak
# minimum gain of a promising factor, as a share of the wanted gain; a sharp peak (see SHARP) that exceeds 0 or a
# neighbour by this share is also refined down to `NARROWEST`
PROMISING = 0.4
SHARP = 0.5  # a peak is sharp if both neighbouring factors gain at most this share of its gain


def bracket(by_factor: Mapping[float, float]) -> float:
    """Return the ratio of the factors on both sides of a sharp peak (see `SHARP`), or 1 if there is none."""
    beside = _beside_peak(by_factor)
    if beside is None:
        return 1.0
    below, above = beside
    sharp = max(by_factor[below], by_factor[above]) <= SHARP * max(by_factor.values())
    return above / below if sharp else 1.0


def between_neighbours(by_factor: Mapping[float, float]) -> float:
    """Return the ratio of the factors on both sides of the best one, or 1 if it has none on one side or no gain."""
    beside = _beside_peak(by_factor)
    return beside[1] / beside[0] if beside is not None else 1.0


def _beside_peak(by_factor: Mapping[float, float]) -> tuple[float, float] | None:
    """Return the factors on both sides of the best one, or None if it has none on one side or gains nothing."""
    factor = max(by_factor, key=by_factor.__getitem__)
    ordered = sorted(one for one in by_factor if one > 0.0)
    if factor not in ordered[1:-1] or by_factor[factor] <= 0.0:
        return None
    place = ordered.index(factor)
    return ordered[place - 1], ordered[place + 1]


def amid(by_factor: Mapping[float, float], slack: float) -> list[float]:
    """Return the factors between neighbouring ones of which the inner gains nothing and the outer loses.

    The old value and factors whose ratio is less than `APART` are left out: first steps lie between them already.
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
    """Return at most two factors to try next, with the sign of the best factor; none if no factor gains.

    Also return none if both neighbours of the best factor are close to it and gain as much, but too little: the cause
    is then elsewhere.

    `by_factor` maps each tried factor to its gain; `wanted` is the gain that restores the designed reward.
    """
    factor = max(by_factor, key=by_factor.__getitem__)
    sign = -1.0 if factor < 0 else 1.0
    gains = {abs(one): gain for one, gain in by_factor.items() if one * sign > 0}
    factor = abs(factor)
    if gains[factor] <= 0:
        return []
    ordered = [min(gains) / OUTWARD**2, *sorted(gains), max(gains) * OUTWARD**2]
    place = ordered.index(factor)
    neighbours = (ordered[place - 1], ordered[place + 1])
    flat = all(one in gains and gains[one] == gains[factor] for one in neighbours)
    if flat and gains[factor] < ALMOST * wanted and neighbours[1] <= FLAT * neighbours[0]:
        return []
    finest = NARROWEST if _narrow(gains, factor, neighbours, wanted) else FINEST
    around = [one for one in neighbours if max(factor, one) > finest * min(factor, one)]
    return [sign * round(sqrt(factor * one), 3) for one in around]


def _narrow(
    gains: Mapping[float, float], factor: float, neighbours: tuple[float, float], wanted: float
) -> bool:
    """Return whether the range of good factors may be narrower than the distance to the neighbouring factors."""
    most = gains[factor]
    if most >= ALMOST * wanted:
        return True
    known = [gains[one] for one in neighbours if one in gains]
    sharp = len(known) == 2 and max(known) <= SHARP * most
    # a large fall of the reward between two close factors shows a narrow range, as a large gain does
    return sharp and most - min(0.0, *known) >= PROMISING * wanted
