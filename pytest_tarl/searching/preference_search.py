"""The part of a search's interface that the search for preferred changes uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.forward_selection import ForwardSelection
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit


class Search(Protocol):
    """The parts of the search that `Preferences` uses."""

    units: tuple[Unit, ...]
    guards: Sequence[Guard]
    mutate: Mutate
    trials: Trials
    goal: Goal
    proposed: bool
    gains: Gains
    refused: set[tuple[Unit, Guard]]

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try one factor on a unit under a guard; yield the candidates that further seeds confirm."""

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """Try factors between the best factor of a unit and the factors next to it."""

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a factor on a unit. Return the candidate if it was not tried before and is confirmed."""

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        """Try a factor on a mission pair's seed and return whether it reaches the goal (False if tried before)."""

    def corrections(self) -> Iterator[Candidate]:
        """Yield confirmed corrections of sensor readings that are wrong from the start. Later calls yield nothing."""

    def joining(self, gains: Mapping[Unit, Mapping[float, float]]) -> ForwardSelection:
        """Return a forward selection, which combines changes of several units."""
