"""Combine the constants that gained in a sweep, or adjust the best of them before it is combined.

Each method decides whether there is anything to combine, and yields confirmed candidates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.jointly import LEAST, Jointly, sensitive
from pytest_tarl.searching.partial_gains import held
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.refining import ALMOST, PROMISING
from pytest_tarl.searching.search import Candidate, Goal, Trials
from pytest_tarl.searching.units import Scope, Unit, whole_constants
from pytest_tarl.searching.unmasking import GAINED, longer, unmasked

if TYPE_CHECKING:
    import numpy as np

STARTS = 3  # number of best points (combinations of factors) at which the joint search starts, at most


class Search(Protocol):
    """The parts of the sweep that `Combining` uses."""

    units: tuple[Unit, ...]
    late: tuple[Unit, ...]
    scope: Scope
    trials: Trials
    goal: Goal
    generator: np.random.Generator | None
    slack: float
    proposed: bool
    gains: Gains
    refused: set[tuple[Unit, Guard]]

    def joining(
        self, gains: Mapping[Unit, Mapping[float, float]], among: Sequence[Unit] | None = None
    ) -> ForwardSelection:
        """Return a forward selection, which combines changes of several units."""


class Combining:
    """Combine the units of one search."""

    def __init__(self, search: Search) -> None:
        self.search = search
        self._unmasked_under: set[tuple[Unit, Guard]] = set()
        self._held: set[tuple[Unit, Guard]] = set()

    def best_with_others(self) -> Iterator[Candidate]:
        """Combine the best operand with others, but a proposed operand only with operands of the same proposal."""
        search = self.search
        every = [
            (gain, *key, factor)
            for key, gains in search.gains.items()
            if key not in search.refused
            for factor, gain in gains.items()
        ]
        gain, unit, guard, factor = max(every, key=lambda one: one[0], default=(0.0, None, None, 1.0))
        if unit is None or guard is None or gain <= search.slack:
            return
        span = unit.operands[0].span
        among = [one for one in search.units if not search.proposed or one.operands[0].span == span]
        joining = search.joining(search.gains.under(guard), among)
        yield from joining.candidates(Joint(((unit, factor),), guard))

    def jointly(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Jointly search the constants that change missions most, starting at the best points so far.

        If the constant that gains most cannot be part of the joint search (such as a number of a table), the search is
        skipped, because the other constants gain nothing without it.
        """
        search = self.search
        if search.generator is None or search.proposed:
            return
        guard = max(guards, key=lambda one: max((gain for gain, _ in search.gains.leaders(one)), default=0.0))
        united = whole_constants((*search.units, *search.late), search.scope)
        chosen, hidden = sensitive(united, search.gains, guard)
        if len(chosen) < LEAST:
            return
        jointly = Jointly(chosen, search.joining({}), search.trials, search.goal, search.generator, hidden)
        best, moved = search.gains.leaders(guard), {one for unit in chosen for one in unit.operands}
        if best and best[0][0] >= PROMISING * search.goal.wanted and moved.isdisjoint(best[0][1][0].operands):
            return
        leaders = [part for _, part in best if part[0] in chosen and part[1] > 0]
        yield from jointly.candidates([Joint((part,), guard) for part in leaders[:STARTS]], guard)

    def leaders(self, guard: Guard) -> Iterator[Candidate]:
        """Combine the best operands of different sites, each with its best factor; their gains are assumed to add up.

        This comes before refused operands are refined further, because the refined values would be nearly the same
        changes again.
        """
        search = self.search
        search.refused -= {tried for tried in search.refused if tried[1] == guard}
        leaders = search.gains.leaders(guard)
        if search.proposed or not leaders or leaders[0][0] >= ALMOST * search.goal.wanted:
            return  # the best change nearly suffices, so it needs a better value and no second constant
        if leaders[0][0] > search.slack:
            hidden = [unit for unit in search.units if not search.gains.moves(unit)]
            yield from search.joining({}).unions([part for _, part in leaders], guard, hidden)

    def held(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """For each guard, try the other named constants together with the best unit's change. This is done once.

        Constants that changed missions when they were tried alone come first.
        """
        search = self.search
        for guard in () if search.proposed else guards:
            for gain, (unit, factor) in search.gains.leaders(guard)[:1]:
                if not GAINED <= gain / search.goal.wanted < ALMOST or (unit, guard) in self._held:
                    continue
                self._held.add((unit, guard))
                rest = [one for one in named(search.units) if not set(one.operands) & set(unit.operands)]
                rest.sort(key=lambda one: not search.gains.moves(one))
                joining = search.joining({})
                for joint, _ in held(Joint(((unit, factor),), guard), rest, joining):
                    before = len(joining.settled.held)
                    yield from joining.candidates_of(joint)
                    if len(joining.settled.held) > before:
                        yield from self._instead(joint, rest)

    def _instead(self, refused: Joint, rest: Sequence[Unit]) -> Iterator[Candidate]:
        """Keep the last constant of a refused combination, and try other constants together with it.

        The combination restores the reward in the drifted world, but it was refused, for example because it does harm
        in the designed world.
        """
        unit, factor = refused.parts[-1]
        others = [one for one in rest if not set(one.operands) & set(unit.operands)]
        yield from unmasked(Joint(((unit, factor),), refused.guard), others, self.search.joining({}))

    def sharpened(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Under each guard, adjust the best unit in small steps before it is combined with others."""
        for guard in () if self.search.proposed else guards:
            for _, (unit, factor) in self.search.gains.leaders(guard)[:1]:
                yield from self.search.joining({}).sharpened(unit, factor, guard)

    def unmasked(self, guard: Guard) -> Iterator[Candidate]:
        """If missions last longer with the best unit's change, combine it with each unit that had no effect alone."""
        search = self.search
        leaders = search.gains.leaders(guard)
        if search.proposed or not leaders or leaders[0][0] < GAINED * search.goal.wanted:
            return
        unit, factor = leaders[0][1]
        base, joining = Joint(((unit, factor),), guard), search.joining({})
        if (unit, guard) in self._unmasked_under or not longer(base, joining):
            return
        self._unmasked_under.add((unit, guard))
        still = [one for one in search.units if not search.gains.moves(one)]
        yield from unmasked(base, [one for one in still if one.operands != unit.operands], joining)
