"""Decide which of several repairs fixes the cause: the one whose missions follow the designed ones from start to end.

For example, the heating elements of a kiln have become weak. A larger constant for the heat loss through the walls
keeps a hot kiln at its temperature. Only the right constant for the heating power also makes the kiln heat up as
designed. Both repairs earn the same total, but at different times.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Part
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.units import Unit

EXACT = 0.002  # maximum deviation (see `course`) of a candidate that is not compared with rivals
CLOSER = 0.6  # a rival is preferred if its deviation is at most this share of the candidate's deviation
COMPARED = 3  # number of missions on which two candidates that pass are compared
# exponents of the factor found: the first factor that passes is often larger than needed
POWERS = (1.0, 0.7)
RIVALS = 8  # maximum number of episodes for rival constants


def rivals(found: Unit, factor: float, units: Sequence[Unit], gains: Gains, guard: Guard) -> Iterator[Part]:
    """Yield the other named constants of the function that contains `found`, each with 1/factor and with factor.

    Weaker factors follow. The reciprocal suits constants that are divisors. Constants that never changed a mission are
    left out. So are constants on another scale than `found`, for which the factor has no meaning.
    """
    at = found.operands[0].site
    tried = gains.under(guard)
    others = []
    for unit in named(units) if factor > 0 else ():
        site = unit.operands[0].site
        beside = (site.module, site.qualname) == (at.module, at.qualname) and unit.chart == found.chart
        if unit != found and beside and (unit not in tried or gains.matters(unit)):
            others.append(unit)
    for power in POWERS:
        yield from ((unit, round(factor**to, 3)) for unit in others for to in (-power, power))
