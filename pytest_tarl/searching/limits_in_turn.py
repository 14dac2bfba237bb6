"""Relax limits one after another, if each limit hides the next and none gains anything alone.

If two limits stop a mission and only the first one is relaxed, the mission stops at the second one. The reward does not
change, so a search that only combines changes which gained reward cannot find the pair. But the mission is different:
it reaches a limit that neither the designed mission nor the unrepaired one reached. This limit is relaxed next, and no
other constant is tried. Each step takes two episodes with the change, one of which is recorded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import log

from pytest_tarl.model import Guard
from pytest_tarl.searching.forward_selection import MOST, PROMISING, ForwardSelection, Joint
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

Limit = tuple[Operand, float]  # a constant, and the factor that relaxes the limit
Reached = Callable[
    [Candidate], Sequence[Limit]
]  # takes a candidate and returns the limits that only its drifted missions reach

FIRST = 3  # maximum number of limits to start from
NEXT = 2  # maximum number of further limits that are tried together with each combination of relaxed limits
EPISODES = 16  # number of episodes after which no further limit is relaxed
FARTHEST = log(20.0)  # maximum |log| of a limit's factor


class LimitsInTurn:
    """Relax, under one guard, the limits that missions reach.

    `whole` maps the constants to the units that are searched. `reached` may run an episode.
    """

    def __init__(
        self, selection: ForwardSelection, whole: Mapping[Operand, Unit], reached: Reached, guard: Guard
    ) -> None:
        self.selection = selection
        self.whole = whole
        self.reached = reached
        self.guard = guard
        self._begun = selection.trials.spent

    def candidates(self, bases: Sequence[Joint] = ()) -> Iterator[Candidate]:
        """Yield confirmed combinations of limits. Raise BudgetSpentError.

        Start from the limits that the unrepaired program reaches, and from `bases`.
        """
        bare = Joint((), self.guard)
        starts = [*self._wider(bare, self.reached(Candidate((), self.guard)))[:FIRST], *bases]
        for start in dict.fromkeys(starts):
            yield from self._from(start, bare, 0.0)

    def _from(self, base: Joint, parent: Joint, before: float) -> Iterator[Candidate]:
        """Run a combination. While missions change but earn too little, also relax the limits that are reached next.

        A combination is not extended in two cases. If it clearly earns less than `parent` (which earned `before`), the
        limit was not an obstacle. If it reaches the goal on this seed, the seed shows no further limit.
        """
        selection = self.selection
        if selection.trials.spent - self._begun >= EPISODES:
            return
        gain = yield from selection.gain(base)
        candidate = base.candidate(selection.mutate)
        if gain is None or candidate in selection.settled.tried or not self._differs(base, parent):
            return
        if gain < before - selection.slack:
            return
        if gain > PROMISING * selection.goal.wanted:
            yield from selection.candidates_of(base)
        if selection.trials.spent - self._begun < EPISODES:
            for wider in self._wider(base, self.reached(candidate))[:NEXT]:
                yield from self._from(wider, base, gain)

    def _wider(self, base: Joint, limits: Sequence[Limit]) -> list[Joint]:
        """Return one combination for each limit, in which that limit is relaxed as well, or relaxed further."""
        found: list[Joint] = []
        for operand, factor in limits:
            unit = self.whole.get(operand)
            if unit is None:
                continue
            by = factor * dict(base.parts).get(unit, 1.0)
            wider = base.with_part(unit, round(by, 3))
            if len(wider.parts) <= MOST and 0.0 < abs(log(by)) <= FARTHEST and wider not in found:
                found.append(wider)
        return found

    def _differs(self, one: Joint, other: Joint) -> bool:
        """Return whether two combinations led to missions with different rewards or lengths."""
        trials, mutate = self.selection.trials, self.selection.mutate
        candidate = one.candidate(mutate)
        if not other.parts:
            return trials.moved(candidate, self.selection.goal.pairs)
        return not trials.same_as(candidate, other.candidate(mutate))
