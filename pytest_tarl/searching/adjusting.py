"""Refine the best constant of a sweep: try factors between its best factor and the factors next to it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Protocol

from pytest_tarl.model import Guard
from pytest_tarl.searching import plateau
from pytest_tarl.searching.exact import exactest
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import Oddness, kind, writing
from pytest_tarl.searching.refining import ALMOST, PROMISING, amid, between, bracket
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand

ROUNDS = 3  # maximum number of consecutive refinements of one operand if its gain is at least `PROMISING`
# the exact value of a unit is searched only if the unit gains at least this share of the wanted gain
LEAST = 0.5
REFINED = 8  # maximum number of runs that refine one operand
# maximum number of consecutive refinements without progress, for an operand that gains less than `PROMISING`
IDLE = 2
# a named constant whose gain has a sharp peak is refined if the two factors beside the peak have at least this ratio
WIDE = 1.4
AMID = 6  # maximum number of constants for which one call of `amid` tries a value between two steps
# when gains are compared, a unit's gain is multiplied by this factor once for each refinement without progress
GIVES_WAY = 0.75
MORE = 0.05  # minimum increase of the gain that counts as progress, as a share of the wanted gain


class Search(Protocol):
    """The parts of the sweep that `Adjusting` uses."""

    goal: Goal
    trials: Trials
    mutate: Mutate
    proposed: bool
    gains: Gains
    slack: float
    refused: set[tuple[Unit, Guard]]
    given: Callable[[Operand], Sequence[Operand]]

    @property
    def pair(self) -> int:
        """Return the index of the mission pair whose seed is used in the current turn."""

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try one factor on a unit under a guard; yield the candidates that further seeds confirm."""

    def expect(self, tries: Iterable[tuple[Unit, Guard, float]], pair: int) -> None:
        """Announce the tries that come next unless a result changes the order."""

    def joining(self, gains: Mapping[Unit, Mapping[float, float]]) -> ForwardSelection:
        """Return a forward selection, which combines changes of several units."""


class Adjusting:
    """Refine the units of one search; `refined` counts the refining runs of each unit and guard."""

    def __init__(self, search: Search) -> None:
        self.search = search
        self.refined: Counter[tuple[Unit, Guard]] = Counter()
        self._idle: Counter[tuple[Unit, Guard]] = Counter()  # refinements since the gain last increased
        self._exact: set[tuple[Unit, Guard]] = set()
        self._varied: set[tuple[Unit, Guard, float]] = set()

    def refine(self, pair: int) -> Iterator[Candidate]:
        """Refine the best operand while its gain approaches the wanted gain.

        Tiny gains are not refined, because a mission that fails slightly later does not indicate the right value. If
        two values have the same gain, the values between them are not tried either: the cause is elsewhere.
        """
        search, wanted = self.search, self.search.goal.wanted
        for _ in range(ROUNDS):
            open_to = self._open()
            if not search.proposed:
                open_to = plateau.nearby(open_to, search.gains, PROMISING * wanted) or open_to
            best = max(open_to, key=self._hopeful, default=None)
            before = search.gains.most(best) if best is not None else 0.0
            if best is None or before <= search.slack:
                return
            yield from self._vary(*best)
            yield from self.between(best, pair)
            gained = search.gains.most(best)
            self._idle[best] = self._idle[best] + 1 if gained <= before + MORE * wanted else 0
            if gained <= max(before, PROMISING * wanted) and gained < ALMOST * wanted:
                return

    def _hopeful(self, key: tuple[Unit, Guard]) -> float:
        """Return the gain of a unit, reduced for each refinement without progress."""
        return self.search.gains.most(key) * GIVES_WAY ** self._idle[key]

    def _open(self) -> list[tuple[Unit, Guard]]:
        """Return the units and guards to refine further. Of several uses with the same effect, return only one."""
        search = self.search
        tried = [key for key, _ in search.gains.items()]
        distinct = set(search.gains.distinct(list(dict.fromkeys(unit for unit, _ in tried))))
        much = PROMISING * search.goal.wanted
        return [
            key
            for key in tried
            if key[0] in distinct
            and key not in search.refused
            and self.refined[key] < _most(key[0])
            and (self._idle[key] < IDLE or search.gains.most(key) >= much or self._in_a_wide_bracket(key))
        ]

    def _in_a_wide_bracket(self, key: tuple[Unit, Guard]) -> bool:
        """Return whether a named constant's gain has a sharp peak between two factors that are far apart."""
        named = kind(key[0]) is Oddness.NAMED and not self.search.proposed
        return named and bracket(self.search.gains.of(*key)) >= WIDE

    def amid(self, guard: Guard) -> Iterator[Candidate]:
        """For each constant, try a value between a step that is too small and the next step, which is too large.

        A step is too small if it earns about as much as the old value. It is too large if it clearly loses reward.
        """
        search = self.search
        found = [
            (kind(unit) is not Oddness.NAMED, -max(gains.values()), unit, step)
            for unit, gains in (() if search.proposed else search.gains.under(guard).items())
            for step in amid(gains, search.slack)
        ]
        for _, _, unit, step in sorted(found, key=lambda one: one[:2])[:AMID]:
            yield from search.attempt(unit, guard, step, search.pair)

    def exactly(self, guard: Guard) -> Iterator[Candidate]:
        """Once, move the best unit under a guard to the value whose missions follow the designed ones most closely.

        If a unit gains much, a more exact value may be all that is missing, so this is tried before the unit is
        combined with others. If it does not suffice, the unit is refined once more.
        """
        search = self.search
        leaders = () if search.proposed else search.gains.leaders(guard)[:1]
        for gain, (unit, factor) in leaders:
            if gain < LEAST * search.goal.wanted or (unit, guard) in self._exact:
                return
            self._exact.add((unit, guard))
            seed = search.goal.pairs[0].seed
            step, _ = exactest(unit, factor, guard, seed, search.mutate, search.trials)
            yield from search.attempt(unit, guard, step, 0)
            yield from self.refine(0)

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """On a log scale, try factors between the operand's best factor and the factors next to it."""
        search = self.search
        # A negative factor corrects the sign. It is refined only if the operand is a proposed value.
        gains = {one: gain for one, gain in search.gains.of(*best).items() if one > 0 or search.proposed}
        steps = between(gains, search.goal.wanted)
        search.expect([(*best, one) for one in steps], pair)
        for one in steps:
            self.refined[best] += 1
            yield from search.attempt(*best, one, pair)

    def _vary(self, unit: Unit, guard: Guard) -> Iterator[Candidate]:
        """If a proposed change gains much, vary its fixed parameters, such as a sensor's usual value."""
        search = self.search
        gains = search.gains.of(unit, guard)
        factor = max(gains, key=gains.__getitem__)
        given = search.given(unit.operands[0]) if search.proposed else ()
        if (unit, guard, factor) in self._varied or gains[factor] < PROMISING * search.goal.wanted:
            return
        self._varied.add((unit, guard, factor))
        for other in given:
            base = Joint(((unit, factor),), guard)
            yield from search.joining({}).climbed(base, Unit((other,)))


def _most(unit: Unit) -> int:
    """Return how many refining runs a unit may have: `REFINED`, or half as many for an offset on a literal 0."""
    return REFINED // 2 if writing(unit.operands[0]) is Oddness.OFFSET else REFINED
