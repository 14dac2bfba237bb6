"""Try values between the old value of a constant and a value with which missions fail for another reason.

For example, a tug brakes too late and runs into the loader. With a much smaller value, the tug drives so slowly that it
arrives too late. Both missions fail and may even earn the same. But they fail for opposite reasons, so the constant
matters and a value in between may be right.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass
from math import isclose, log, sqrt
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit

MOST = 6  # maximum number of constants that are tried under a guard
STEPS = 3  # maximum number of values that are tried between the two values, each in one episode


class Search(Protocol):
    """The parts of the search that `in_between` uses."""

    mutate: Mutate
    trials: Trials
    goal: Goal
    gains: Gains

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try a factor; yield the candidate if it is confirmed."""

    def ran_on(self, unit: Unit, guard: Guard, factor: float) -> int:
        """Return the index of the mission pair whose seed the first mission of a change used."""


@dataclass(frozen=True, slots=True)
class Bracket:
    """A factor with which a pair's mission fails, but for another reason than without the factor."""

    unit: Unit
    factor: float
    pair: int
    unchanged: str  # why the mission fails without a change
    changed: str  # why the mission fails with the factor


def in_between(search: Search, guard: Guard, units: Sequence[Unit]) -> Generator[Candidate, None, bool]:
    """If two factors fail for different reasons, bisect between them on a log scale until a factor succeeds.

    Return whether any constant was tried.
    """
    found = [one for unit in units for one in _brackets(search, guard, unit)]
    for bracket in sorted(found, key=lambda one: abs(log(one.factor)))[:MOST]:
        yield from _halved(search, guard, bracket)
    return bool(found)


def _brackets(search: Search, guard: Guard, unit: Unit) -> Iterator[Bracket]:
    """Yield the factors nearest to 1, one larger and one smaller, with which missions fail for another reason."""
    tried = [factor for factor in search.gains.of(unit, guard) if factor > 0.0 and not isclose(factor, 1.0)]
    larger = sorted(factor for factor in tried if factor > 1.0)
    smaller = sorted((factor for factor in tried if factor < 1.0), reverse=True)
    for side in (larger, smaller):
        for factor in side:
            pair = search.ran_on(unit, guard, factor)
            before = search.trials.reason(search.goal.pairs[pair])
            after = _reason(search, _outcome(search, guard, unit, factor, pair))
            if before and after and before != after:
                yield Bracket(unit, factor, pair, before, after)
                break


def _halved(search: Search, guard: Guard, bracket: Bracket) -> Iterator[Candidate]:
    inner, outer = 1.0, bracket.factor
    for _ in range(STEPS):
        middle = sqrt(inner * outer)
        yield from search.attempt(bracket.unit, guard, middle, bracket.pair)
        outcome = _outcome(search, guard, bracket.unit, middle, bracket.pair)
        reason = _reason(search, outcome)
        if reason == bracket.unchanged:
            inner = middle
        elif reason == bracket.changed:
            outer = middle
        else:
            return


def _outcome(search: Search, guard: Guard, unit: Unit, factor: float, pair: int) -> Outcome | None:
    candidate = Candidate(unit.mutations(search.mutate, factor), guard)
    ran = search.trials.ran(candidate, [search.goal.pairs[pair]]) if candidate.mutations else []
    return ran[0] if ran else None


def _reason(search: Search, outcome: Outcome | None) -> str:
    """Return why a mission failed, or "" if it did not or the reason is unknown."""
    return outcome.failure if outcome is not None and search.goal.lost(outcome) else ""
