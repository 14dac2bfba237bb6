"""Find the factor of a constant with which missions follow the designed ones most closely.

A changed world makes the value of a constant wrong. With the value that is right for this world, missions earn the same
reward at the same times as in the designed world. On both sides of the right value, the deviation of missions (see
`course`) grows about linearly, so a few missions show where the minimum lies.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf

WEAKER, STRONGER = 0.7, 1.3  # exponents of the factor that are tried first
LEAST, MOST = 0.1, 2.5  # bounds of the exponent
SAME = 0.05  # exponents this close to 1 count as 1


def nearest(factor: float, deviation: Callable[[float], float]) -> tuple[float, float]:
    """Return the factor with the least deviation found, and that deviation; `factor` must be positive.

    `deviation` returns the deviation of missions with a factor. It is called for at most five factors.
    """
    tried = {1.0: deviation(factor)}

    def at(power: float) -> float:
        if power not in tried:
            tried[power] = deviation(_raised(factor, power))
        return tried[power]

    if at(WEAKER) < at(1.0):
        _approach(1.0, WEAKER, at)
    elif at(STRONGER) < at(1.0):
        _approach(1.0, STRONGER, at)
    else:
        # both sides are worse: try a value towards the better side, since distant values may fail on only one side
        at(_between(1.0, min(WEAKER, STRONGER, key=at), at))
    power = min(tried, key=lambda one: (tried[one], abs(one - 1.0)))
    return (factor if power == 1.0 else _raised(factor, power)), tried[power]


def _approach(start: float, better: float, at: Callable[[float], float]) -> None:
    """Try the likely place of the minimum between two exponents, then the likely place beyond the better exponent."""
    if at(_between(start, better, at)) < at(better):
        return
    slope = (at(start) - at(better)) / (start - better)
    at(min(max(better - at(better) / slope, LEAST), MOST))


def _between(one: float, other: float, at: Callable[[float], float]) -> float:
    """Return where the minimum between two exponents lies if the deviation falls equally fast on both sides."""
    whole = at(one) + at(other)
    share = at(one) / whole if 0.0 < whole < inf else 0.5
    found = one + (other - one) * share
    return 1.0 if abs(found - 1.0) < SAME else found


def _raised(factor: float, power: float) -> float:
    return float(f"{factor**power:.4g}")
