"""The parts of a search that the search for preferred changes uses."""

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
        """Try a factor; yield the candidates that are confirmed."""

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """Try factors between the unit's best factor and its neighbours."""

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a factor; return the candidate if it is new and confirmed."""

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int) -> bool:
        """Return whether a new factor reaches the goal on the seed of a pair."""

    def corrections(self) -> Iterator[Candidate]:
        """Yield the confirmed corrections of sensor readings that are wrong from the start, if not done before."""

    def joining(self, gains: Mapping[Unit, Mapping[float, float]]) -> ForwardSelection:
        """Return a selection that combines units."""
