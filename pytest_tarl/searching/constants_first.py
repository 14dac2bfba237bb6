"""Before a structural change is yielded, try constants in its place: a maintainer prefers to change a constant.

A template that uses a sensor can fit the few values that the sensor has in both worlds by chance. The constant that is
wrong often gained a little at one factor, while the factors on both sides of it gained nothing. If a change scales a
whole command, the same factor on a constant of the command may do the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.confirming import confirmed, suffices
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import Oddness, kind
from pytest_tarl.searching.refining import between
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit

CONSTANTS = 2  # maximum number of constants that are refined before the first structural change
EPISODES = 8  # maximum number of episodes for each of them, without confirmations
MADE_OF = 8  # maximum number of constants that are tried in place of a factor on a command

Lines = tuple[str, int, int]  # path, first and last line of a statement


@dataclass(frozen=True)
class Scaled:
    """A factor on a command, and the statements that compute the command, nearest to it first."""

    factor: float
    statements: tuple[Lines, ...]

    def place(self, unit: Unit) -> int | None:
        """Return the index of the statement that uses all of a unit's constants, or None."""
        spans = [operand.span for operand in unit.operands]
        return next(
            (
                at
                for at, (path, first, last) in enumerate(self.statements)
                if all(span.path == path and first <= span.line <= last for span in spans)
            ),
            None,
        )


class Search(Protocol):
    """The parts of the search of constants that `constants_first` uses."""

    units: tuple[Unit, ...]
    mutate: Mutate
    gains: Gains
    slack: float
    refused: set[tuple[Unit, Guard]]

    def ran_on(self, unit: Unit, guard: Guard, factor: float) -> int:
        """Return the index of the pair on whose seed a change ran first."""


def constants_first(
    structures: Iterator[Candidate],
    search: Search,
    trials: Trials,
    goal: Goal,
    scaled: Callable[[Candidate], Scaled | None] = lambda _: None,
) -> Iterator[Candidate]:
    """Yield structural changes; before the first one, yield refined constants that are confirmed.

    If a change scales a command (`scaled`), constants of the command that are confirmed with the same factor come
    before the change. Raise BudgetSpentError.
    """
    for number, structure in enumerate(structures):
        if not number:
            yield from _refined(search, trials, goal)
        command = scaled(structure)
        if command is not None:
            yield from _of_the_command(command, structure.guard, search, trials, goal)
        yield structure


def _of_the_command(
    command: Scaled, guard: Guard, search: Search, trials: Trials, goal: Goal
) -> Iterator[Candidate]:
    """Yield the constants of a command that are confirmed with its factor, nearest to the command first."""
    placed = [(at, unit) for unit in search.units if (at := command.place(unit)) is not None]
    for _, unit in sorted(placed, key=lambda one: one[0])[:MADE_OF]:
        value = unit.operands[0].value
        if (unit, guard) in search.refused or unit.chart is not None or value == 0 or isinstance(value, bool):
            continue
        candidate = Candidate(unit.mutations(search.mutate, command.factor), guard)
        if candidate.mutations and suffices(candidate, trials, goal):
            yield candidate


def _refined(search: Search, trials: Trials, goal: Goal) -> Iterator[Candidate]:
    """Refine the named constants that gained most, each on the seed on which it gained."""
    leaders = [
        key
        for key, _ in search.gains.items()
        if kind(key[0]) is Oddness.NAMED
        and key not in search.refused
        and search.gains.most(key) > search.slack
    ]
    for unit, guard in sorted(leaders, key=lambda key: -search.gains.most(key))[:CONSTANTS]:
        known = search.gains.of(unit, guard)
        pair = search.ran_on(unit, guard, max(known, key=known.__getitem__))
        yield from _on_one_seed(search, (unit, guard), pair, trials, goal)


def _on_one_seed(
    search: Search, key: tuple[Unit, Guard], at: int, trials: Trials, goal: Goal
) -> Iterator[Candidate]:
    """Halve the distance to the neighbours of the best factor, comparing all factors on the seed of one pair."""
    (unit, guard), pair, begun = key, goal.pairs[at], trials.spent
    gains = {1.0: 0.0}
    steps = [factor for factor in _around(search.gains.of(unit, guard)) if factor != 1.0]
    while steps and trials.spent - begun < EPISODES:
        for step in steps:
            candidate = Candidate(unit.mutations(search.mutate, step), guard)
            try:
                outcome = trials(candidate, pair.seed)
            except RepairError:
                return
            gains[step] = outcome.total - pair.total
            if goal.reached(outcome, pair.seed) and confirmed(candidate, trials, goal, at):
                yield candidate
                return
        steps = [step for step in between(gains, goal.wanted) if step not in gains]


def _around(gains: Mapping[float, float]) -> list[float]:
    """Return the best factor and its neighbours."""
    ordered = sorted(one for one in gains if one > 0.0)
    best = max(gains, key=gains.__getitem__)
    if best not in ordered:
        return []
    place = ordered.index(best)
    return ordered[max(place - 1, 0) : place + 2]
