"""Choose the repair that fixes the cause: its missions follow the designed missions from start to end.

For example, the heating elements of a kiln have become weak. If the program's constant for the heat loss through the
walls is made larger, a hot kiln keeps its temperature. Only the right constant for the heating power also makes the
kiln heat up as designed. Both repairs earn the same total reward, but at different times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Part
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.units import Unit

# a candidate is compared with other constants (rivals) only if its deviation (see `course`) is larger than this
EXACT = 0.002
# a rival constant is preferred if its deviation is at most this share of the candidate's deviation
CLOSER = 0.6
COMPARED = 3  # number of missions on which two passing candidates are compared
# exponents for the factor that was found, because the first factor that passes is often larger than needed
POWERS = (1.0, 0.7)
GAINED = 0.03  # a constant of another function must gain at least this share of what the found constant gains
ASIDE = 2  # maximum number of constants of other functions that are tried
RIVALS = 8  # maximum number of episodes for trying rival constants


def rivals(found: Unit, factor: float, units: Sequence[Unit], gains: Gains, guard: Guard) -> Iterator[Part]:
    """Yield other named constants that may be the cause (rivals), each with factors to try.

    - First come constants of other functions in the file that gained reward, with a factor in the direction that
      gained.
    - Then come the other constants of the function that contains `found`, each with `1 / factor` and `factor`. The
      reciprocal suits divisors.
    - Those of them that gained come again, with weaker factors.

    Constants that never changed a mission are left out. Constants on another scale than `found` are left out, too,
    because the factor has no meaning for them.
    """
    at = found.operands[0].site
    tried = gains.under(guard)
    others = []
    for unit in named(units) if factor > 0 else ():
        site = unit.operands[0].site
        beside = (site.module, site.qualname) == (at.module, at.qualname) and unit.chart == found.chart
        if unit != found and beside and (unit not in tried or gains.matters(unit)):
            others.append(unit)
    aside = [
        unit
        for unit in (named(units) if factor > 0 else ())
        if unit != found
        and unit not in others
        and unit.operands[0].span.path == found.operands[0].span.path
        and unit.chart == found.chart
        and max(tried.get(unit, {1.0: 0.0}).values()) > GAINED * max(gains.most((found, guard)), 0.0)
    ]
    aside = sorted(aside, key=lambda unit: (-max(tried[unit].values()), _is_local(unit)))[:ASIDE]
    yield from ((unit, round(factor if _towards(tried[unit], factor) else 1.0 / factor, 3)) for unit in aside)
    for number, power in enumerate(POWERS):
        if number and others:
            first = {round(factor**to, 3) for to in (-POWERS[0], POWERS[0])}
            tried = gains.under(guard)
            others = [
                unit
                for unit in others
                if any(tried.get(unit, {}).get(one, 0.0) > gains.slack for one in first)
            ]
        yield from ((unit, round(factor**to, 3)) for unit in others for to in (-power, power))


def _towards(gains: Mapping[float, float], factor: float) -> bool:
    """Return whether the factor that gained most changes the constant in the same direction as `factor`."""
    return (max(gains, key=gains.__getitem__) > 1.0) == (factor > 1.0)


def _is_local(unit: Unit) -> bool:
    """Return whether a unit is a local variable, whose value comes from other constants."""
    return unit.operands[0].code.islower() and unit.operands[0].code.isidentifier()
