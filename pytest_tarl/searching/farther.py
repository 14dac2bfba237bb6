"""Farther steps on named constants, tried once before combinations and structural changes.

If a constant needs five times its value, the first steps may gain nothing or even lose a little: half of the right
correction can be as wrong as no correction. Trying a few named constants costs less than trying many expressions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.adjusting import Adjusting
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.refining import FURTHER
from pytest_tarl.searching.search import Candidate, Goal
from pytest_tarl.searching.units import Unit

MOST = 6  # maximum number of constants for each step
# maximum loss with the smaller step in the same direction, as a share of the wanted gain
BEARABLE = 0.25


class Search(Protocol):
    """The parts of the search of constants that `farther` uses."""

    units: tuple[Unit, ...]
    guards: Sequence[Guard]
    gains: Gains
    goal: Goal
    slack: float
    turn: int
    refused: set[tuple[Unit, Guard]]
    adjusting: Adjusting

    @property
    def pair(self) -> int:
        """Return the index of the mission pair whose seed is used in the current turn."""

    def each(self, factor: float, guard: Guard, among: Sequence[Unit], pair: int) -> Iterator[Candidate]:
        """Try one factor on several operands, on the seed of a pair."""


def farther(search: Search) -> Iterator[Candidate]:
    """Try larger steps on named constants and refine after each step. Yield the confirmed candidates.

    If possible, the candidates have no condition. The acceptance test finds out whether the repair needs a condition.
    """
    guard = ALWAYS if ALWAYS in search.guards else search.guards[0]
    for factor, before in FURTHER:
        among = _open(search, guard, before)
        if among:
            pair = search.pair
            search.turn += 1
            yield from search.each(factor, guard, among, pair)
            yield from search.adjusting.refine(pair)


def _open(search: Search, guard: Guard, before: float) -> list[Unit]:
    """Return the constants that neither gained clearly nor lost more than `BEARABLE` so far, best first.

    Gains are those with `before`, the smaller step. The following constants are left out:

    - constants that gained clearly, because refining moves them as far
    - constants on which the smaller step had no effect, such as a limit that is never reached
    - the single uses of a constant that has several uses
    """
    gains = search.gains
    whole = [unit for unit in named(search.units) if not any(_part_of(unit, one) for one in search.units)]
    least = -BEARABLE * search.goal.wanted
    leading = gains.leading(before, guard, [unit for unit in whole if unit.chart is None], least)
    return [
        unit
        for unit in leading
        if gains.of(unit, guard)[before] <= search.slack
        and gains.moved_by(unit, before)
        and (unit, guard) not in search.refused
    ][:MOST]


def _part_of(unit: Unit, other: Unit) -> bool:
    return {*unit.operands} < {*other.operands}
