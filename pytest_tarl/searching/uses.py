"""If several statements use a constant, change it at only one of its uses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.search import Candidate, Trials
from pytest_tarl.searching.units import Unit

MOST = 3  # maximum number of uses of a constant that are changed alone


class Search(Protocol):
    """The parts of the sweep that `Uses` uses."""

    trials: Trials

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try one factor on a unit under a guard; yield the candidates that further seeds confirm."""

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int, confirmable: bool = True) -> bool:
        """Try a factor on a mission pair's seed and return whether it reaches the goal (False if tried before)."""


class Uses:
    """The uses of each constant of one search; `parts` maps a constant to its uses."""

    def __init__(self, search: Search, parts: Mapping[Unit, tuple[Unit, ...]]) -> None:
        self.search = search
        self.parts = parts
        self._apart: set[tuple[Unit, Guard]] = set()  # constants whose uses `alone` has tried

    def of(self, whole: Unit) -> tuple[Unit, ...]:
        """Return the uses of a constant, or none if there is only one."""
        return self.parts.get(whole, ())

    def learn(self, whole: Unit, guard: Guard, factor: float, pair: int) -> None:
        """Change each use of a confirmed constant alone, on one seed, to learn which statements matter."""
        uses, trials = self.of(whole), self.search.trials
        if len(uses) <= MOST and trials.budget - trials.spent > len(uses):
            for use in uses:
                self.search.reaches(use, factor, guard, pair, confirmable=False)

    def alone(self, whole: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """If a constant reached the goal on only some seeds, try to change each of its uses alone. This is done once.

        The change at the other uses may be the reason why missions fail on the other seeds.
        """
        uses = self.of(whole)
        if len(uses) <= MOST and (whole, guard) not in self._apart:
            self._apart.add((whole, guard))
            for use in uses:
                yield from self.search.attempt(use, guard, factor, pair)
