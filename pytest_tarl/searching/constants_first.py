"""Before a structural change is yielded, try to change a constant instead, which a maintainer would prefer.

A structural change that uses a sensor can fit by chance, because the sensor has only a few values in both worlds. The
constant that is really wrong often gained a little with one factor and nothing with the factors beside it. If a change
scales a whole command, the same factor on one constant of the command may have the same effect.
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
EPISODES = 8  # maximum number of episodes for each of these constants, without confirmations
MADE_OF = 8  # maximum number of constants that are tried instead of a factor on a command

Lines = tuple[str, int, int]  # path, first and last line of a statement


@dataclass(frozen=True)
class Scaled:
    """A factor on a command, and the statements that compute the command. Statements near the command come first."""

    factor: float
    statements: tuple[Lines, ...]

    def place(self, unit: Unit) -> int | None:
        """Return the index of the statement with all constants of a unit, or None."""
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
        """Return the index of the mission pair whose seed the first mission of a change used."""


def constants_first(
    structures: Iterator[Candidate],
    search: Search,
    trials: Trials,
    goal: Goal,
    scaled: Callable[[Candidate], Scaled | None] = lambda _: None,
) -> Iterator[Candidate]:
    """Yield structural changes. Before the first one, yield confirmed changes of constants.

    If a structural change scales a command (see `scaled`), try the same factor on constants of the command. Those that
    are confirmed come before the structural change. Raise BudgetSpentError.
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
    """Yield confirmed candidates that apply the command's factor to one constant, nearest to the command first."""
    placed = [(at, unit) for unit in search.units if (at := command.place(unit)) is not None]
    for _, unit in sorted(placed, key=lambda one: one[0])[:MADE_OF]:
        value = unit.operands[0].value
        if (unit, guard) in search.refused or unit.chart is not None or value == 0 or isinstance(value, bool):
            continue
        candidate = Candidate(unit.mutations(search.mutate, command.factor), guard)
        if candidate.mutations and suffices(candidate, trials, goal):
            yield candidate


def _refined(search: Search, trials: Trials, goal: Goal) -> Iterator[Candidate]:
    """Refine the named constants that gained most. Each runs on the seed on which it gained."""
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
    """Try factors halfway between the best factor and its neighbours; compare all factors on the seed of one pair."""
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
            gains[step] = goal.gain(outcome, pair.total)
            if goal.reached(outcome, pair.seed) and confirmed(candidate, trials, goal, at):
                yield candidate
                return
        steps = [step for step in between(gains, goal.wanted) if step not in gains]


def _around(gains: Mapping[float, float]) -> list[float]:
    """Return the best factor and the factors next to it."""
    ordered = sorted(one for one in gains if one > 0.0)
    best = max(gains, key=gains.__getitem__)
    if best not in ordered:
        return []
    place = ordered.index(best)
    return ordered[max(place - 1, 0) : place + 2]
