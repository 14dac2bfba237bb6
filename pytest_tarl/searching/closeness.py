"""Decide which of several repairs is at the cause: with it, missions go as designed from start to end.

For example, if the heating elements of a kiln are weak, a controller with a larger constant for the loss of the walls
keeps the hot kiln at its temperature. But only the right constant for the power also lets the kiln heat up as designed.
Both repairs earn the same total, at different times.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Part
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.units import Unit

EXACT = 0.01  # deviation up to which a mission goes as designed
CLOSER = 0.6  # a candidate is preferred if it deviates at most by this share of the other's deviation
COMPARED = 3  # missions on which two candidates that hold are compared
POWERS = (1.0, 0.7)  # of the factor found; a first factor that holds is often larger than needed
RIVALS = 8  # maximum number of runs of other constants for a candidate that deviates


def rivals(found: Unit, factor: float, units: Sequence[Unit], gains: Gains, guard: Guard) -> Iterator[Part]:
    """Yield other named constants of the same function, with the factor found and its reciprocal, then weaker ones.

    A constant that divides needs the reciprocal. Left out are constants that never changed a mission, and constants on
    other scales, for which the factor has no meaning.
    """
    at = found.operands[0].site
    tried = gains.under(guard)
    others = []
    for unit in named(units) if factor > 0 else ():
        site = unit.operands[0].site
        same = (site.module, site.qualname) == (at.module, at.qualname)
        if unit != found and unit.chart == found.chart and same and (unit not in tried or gains.moves(unit)):
            others.append(unit)
    for power in POWERS:
        yield from ((unit, round(factor**to, 3)) for unit in others for to in (-power, power))
