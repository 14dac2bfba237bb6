"""Decide whether a change is extreme, and choose moderate changes of other constants to try before it.

For example, a loaded robot overshoots its stops by a few centimetres. A speed eleven times as high hides this by
chance. The right repair increases the ticks per metre by 4 %.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

from pytest_tarl.model import Guard
from pytest_tarl.searching.gains import Gains, Part
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.units import Unit, change_size

LARGE = 8.0  # a change by at least this factor counts as unusually large
STEPS = (1.1, 0.91, 1.05, 0.95)  # factors of the moderate changes
MODERATE = 12  # number of episodes after which no further moderate change is tried


def extreme(unit: Unit, factor: float) -> bool:
    """Return whether a change scales a constant by `LARGE` or more; False for a constant of 0."""
    value = unit.operands[0].value
    return (
        bool(value)
        and not isinstance(value, bool)
        and factor > 0.0
        and change_size(unit, factor) >= log(LARGE)
    )


def moderate(found: Unit, units: Sequence[Unit], gains: Gains, guard: Guard) -> list[Part]:
    """Return untried small steps of the other named constants that matter, the most sensitive constants first.

    A constant is sensitive if its smallest step so far cost much reward: its good values are close to the old one.
    """
    tried = gains.under(guard)
    others = [
        unit
        for unit in named(units)
        if unit.operands != found.operands
        and unit.chart is None
        and not isinstance(unit.operands[0].value, bool)
        and gains.matters(unit)
    ]
    others.sort(key=lambda unit: min(tried.get(unit, {1.0: 0.0}).values()))
    return [(unit, step) for unit in others for step in STEPS if step not in tried.get(unit, {})]
