"""Try single changes in the drifted world, store their gains, and confirm the good ones on further seeds.

Before a confirmed change is yielded, try the changes that a maintainer would prefer to it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from statistics import fmean
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.acting import Acting
from pytest_tarl.searching.adjusting import Adjusting
from pytest_tarl.searching.combining import Combining
from pytest_tarl.searching.constants_first import constants_first
from pytest_tarl.searching.divided import divided, stronger_and_weaker
from pytest_tarl.searching.farther import farther
from pytest_tarl.searching.forward_selection import ForwardSelection, Settled
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.lost_missions import MOVES, better_factor
from pytest_tarl.searching.plainness import Oddness, writing
from pytest_tarl.searching.polishing import ALMOST, EPISODES, FINE_STEPS, KNOWN
from pytest_tarl.searching.preferred_first import then
from pytest_tarl.searching.preferring import Preferences
from pytest_tarl.searching.refining import between_neighbours, bracket
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.suggestions import NO_SUGGESTIONS, Suggestions
from pytest_tarl.searching.twins import twin_of
from pytest_tarl.searching.units import Scope, Unit, everywhere, runs_once
from pytest_tarl.searching.uses import Uses
from tarl_lint.model import Operand

if TYPE_CHECKING:
    import numpy as np

FLIP = -1.0  # factor that flips the sign
# maximum number of units that are tried with the opposite sign, among the units that gained with a smaller value
FLIPPED = 3
SLACK = 0.1  # gains and losses up to this share of the wanted gain count as noise
# maximum number of easy mission pairs; until a change gains, changes run on the seeds of these pairs
EASY = 3
# a gain below this share of the wanted gain is hollow (no progress) if the missions only fail sooner
PARTLY = 0.3
# a constant is adjusted in small steps only if the two tried values beside its best value have at most this ratio
NARROW = 1.6
# the limit used instead of `NARROW` if both values earn nearly as much, because the constant then gets no larger steps
CLOSE = 1.21
LOST = 0.5  # a mission pair can be easy only if its loss is at least this share of the wanted gain


class Attempts:
    """The changes that one search has tried, and the gains of its units; see `Sweep` for the arguments.

    `parts` maps a constant to its uses. All changes of one step run on the seed of one pair, and the next step uses the
    next pair. Until a change gains, only easy pairs are used, that is, pairs whose missions lost least. On these pairs,
    the range of good values is widest.
    """

    def __init__(
        self,
        units: tuple[Unit, ...],
        mutate: Mutate,
        guards: Sequence[Guard],
        trials: Trials,
        goal: Goal,
        *,
        parts: Mapping[Unit, tuple[Unit, ...]] = MappingProxyType({}),
        late: tuple[Unit, ...] = (),
        generator: np.random.Generator | None = None,
        proposed: bool = False,
        weaker: Callable[[Operand, float], bool] = lambda _, __: False,
        given: Callable[[Operand], Sequence[Operand]] = lambda _: (),
        finer: Callable[[Operand], object] = lambda _: None,
        scope: Scope = everywhere,
        suggestions: Suggestions = NO_SUGGESTIONS,
    ) -> None:
        self.units = units
        self.mutate = mutate
        self.guards = guards
        self.trials = trials
        self.goal = goal
        self.late = late
        self.generator = generator
        self.proposed = proposed
        self.weaker = weaker
        self.given = given
        self.finer = finer
        self.scope = scope
        self.suggestions = suggestions
        self.corrections = suggestions.corrections
        self._went_farther = False
        self.slack = SLACK * goal.wanted
        self.turn = 0
        # units whose change was confirmed and yielded, but refused by the caller
        self.refused: set[tuple[Unit, Guard]] = set()
        self._acting = Acting(trials, goal)
        self.gains = Gains(self.slack, proposed, None if proposed else self._acting)
        self.uses = Uses(self, parts)
        self.preferences = Preferences(self)
        self.combining = Combining(self)
        self.adjusting = Adjusting(self)
        # groups of constants that are tried together once one of them gains
        self.twins: tuple[Unit, ...] = ()
        self._easy = easy(goal)
        self._ran_on: dict[tuple[Unit, Guard, float], int] = {}  # change → mission pair of its first run
        self._tried: set[Candidate] = set()
        self._divided: set[Unit] = set()  # units that need different values in different missions
        # units that were adjusted because their change earned nearly enough
        self._adjusted: set[tuple[Unit, Guard]] = set()
        # how often the value of a unit was adjusted because it lost the same missions as rejected candidates
        self._moved: Counter[tuple[Unit, Guard]] = Counter()
        self._settled = Settled()

    def interlude(self, gain: float) -> Iterator[Candidate]:
        """Yield structural changes, but first changes of the constants that gained; `gain` is the largest gain so far.

        If anything gained, try farther steps on named constants before the first structural changes. Farther steps are
        tried only once.
        """
        if self.suggestions.due(gain) and self.gains.anything():
            yield from self.farther()
            gain = max(gain, self.gains.best())
        changes = self.suggestions.interlude(gain)
        yield from constants_first(changes, self, self.trials, self.goal, self.suggestions.scaled)

    def farther(self) -> Iterator[Candidate]:
        """Try farther steps on named constants, once (see `farther`)."""
        if not (self.proposed or self._went_farther):
            self._went_farther = True
            yield from farther(self)

    @property
    def pair(self) -> int:
        """Return the index of the mission pair whose seed is used in the current turn.

        While nothing gains, changes of constants run on the seeds that lost least. Structural changes run on all seeds.
        On easy seeds, a value that is only nearly right earns enough, so the search might refine the wrong change.
        """
        every = range(len(self.goal.pairs))
        among = every if self.proposed or self.gains.anything() else self._easy
        return among[self.turn % len(among)]

    def sweep(self, factor: float, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try one factor on several operands, then refine the best one."""
        yield from self.interlude(self.gains.best())
        pair = self.pair
        self.turn += 1
        yield from self.each(factor, guard, among, pair)
        yield from self._as_twins(factor, guard, among)
        if 0.0 < factor < 1.0:
            for unit in self.leading(factor, guard, self.slack)[:FLIPPED]:
                yield from self.attempt(unit, guard, FLIP, pair)
        yield from self.adjusting.refine(pair)

    def each(self, factor: float, guard: Guard, among: Sequence[Unit], pair: int) -> Iterator[Candidate]:
        """Try one factor on several operands, on the seed of a pair."""
        among = self.gains.distinct(among)
        for at, unit in enumerate(among):
            self.expect([(each, guard, factor) for each in among[at:]], pair)
            yield from self.attempt(unit, guard, factor, pair)

    def _as_twins(self, factor: float, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Take the constants that just gained with a factor, best first, and try the factor on all their twins."""
        gained = {unit: self.gains.of(unit, guard).get(factor, 0.0) for unit in among}
        for unit in sorted(gained, key=lambda one: -gained[one]):
            twin = twin_of(unit, self.twins) if gained[unit] > self.slack else None
            if twin is not None:
                self.units = self.units if twin in self.units else (*self.units, twin)
                yield from self.attempt(twin, guard, factor, self.ran_on(unit, guard, factor))

    def leading(self, before: float, guard: Guard, least: float) -> list[Unit]:
        """Return the units whose gain with the factor `before` is at least `least`, best first."""
        return self.gains.leading(before, guard, self.units, least)

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try a factor. If the candidate is confirmed, yield the changes preferred to it, then the candidate itself."""
        mutations = unit.mutations(self.mutate, factor)
        candidate = Candidate(mutations, guard)
        if not mutations or candidate in self._tried:
            return
        if self.gains.idle(unit) and self.weaker(unit.operands[0], factor):
            return
        self._tried.add(candidate)
        self._ran_on[unit, guard, factor] = pair
        near = self._near(candidate, pair)
        if near is None:
            return
        self._learn(unit, candidate, factor)
        holds = near and self._settled.holds(candidate, self.trials, self.goal, pair)
        self._learn(unit, candidate, factor)
        preferred = self.preferences.before(candidate, unit, factor, pair, holds, near)
        if holds:
            self.uses.learn(unit, guard, factor, pair)
            yield from then(candidate, preferred)
            yield from self.preferences.after()
            yield from self._later(unit, guard, factor, pair)
        else:
            yield from preferred
            if near:
                yield from self._moved_on(unit, candidate, factor, pair)
                yield from self._nearly(unit, candidate, factor, pair)
                yield from self._following(unit, candidate, factor, pair)
                yield from self.uses.alone(unit, guard, factor, pair)
        if holds or (near and self.trials.loses(candidate)):
            self.refused.add((unit, guard))

    def _later(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """If the change of a value at its definition was refused, change the value where it is used.

        A table at module level is built before any sensor has a value, so no condition can be written there.
        """
        if self.proposed or not runs_once(unit):
            return
        for other in self.gains.acting_alike(unit, guard, self.units):
            if not runs_once(other):
                candidate = self.holding(other, factor, guard, pair)
                if candidate is not None:
                    yield candidate
                    return

    def _moved_on(self, unit: Unit, candidate: Candidate, factor: float, pair: int) -> Iterator[Candidate]:
        """If a value loses the same missions as rejected candidates, adjust it once more (see `lost_missions`)."""
        key = (unit, candidate.guard)
        if self.proposed or self._moved[key] >= MOVES or not self.trials.loses(candidate):
            return
        self._moved[key] += 1
        tried = self.gains.of(unit, candidate.guard)
        better = better_factor(unit, candidate, factor, tried, self.mutate, self.trials)
        if better is not None:
            yield from self.attempt(unit, candidate.guard, better, pair)

    def _nearly(self, unit: Unit, candidate: Candidate, factor: float, pair: int) -> Iterator[Candidate]:
        """If a change passes its missions and earns nearly enough, adjust its value before other changes are tried.

        Such a change is of the right kind, but its value is inexact. A constant is adjusted in small steps only in two
        cases, because otherwise the larger steps of `adjusting` are better:

        - Both neighbouring values are close and earn much less.
        - Both neighbouring values are so close that `adjusting` tries no value between them.
        """
        goal, key = self.goal, (unit, candidate.guard)
        ran, totals = self.trials.ran(candidate, goal.pairs), self.trials.totals_of(candidate, goal.pairs)
        if key in self._adjusted or len(ran) < KNOWN or any(map(goal.lost, ran)):
            return
        tried = self.gains.of(unit, candidate.guard)
        peak = max(tried, key=tried.__getitem__)
        narrow = 1.0 < bracket(tried) <= NARROW or 1.0 < between_neighbours(tried) <= CLOSE
        if not self.proposed and not (peak == factor and narrow):
            return
        if not self.proposed and writing(unit.operands[0]) is Oddness.OFFSET:
            return  # an offset on a literal zero is hardly ever the repair that a maintainer would write
        if fmean(totals.values()) < goal.enough_on(list(totals)) - (1.0 - ALMOST) * goal.wanted:
            return
        self._adjusted.add(key)
        form = candidate.mutations[0].form
        if form is not None and form.parameter:
            factor = float(candidate.mutations[0].value)  # `factor` rounded to the grid of the parameter
        self.finer(unit.operands[0])
        with self.trials.granting(EPISODES):
            better = self.joining({}).sharper(unit, factor, candidate.guard, FINE_STEPS)
            yield from self.attempt(unit, candidate.guard, better, pair)

    def _following(self, unit: Unit, candidate: Candidate, factor: float, pair: int) -> Iterator[Candidate]:
        """If a constant needs different values in different missions, let it follow a varying quantity (tried once)."""
        guard, gains = candidate.guard, self.gains.of(unit, candidate.guard)
        if self.proposed or unit in self._divided or factor <= 0.0:
            return
        middle = divided(unit, guard, factor, gains, self.mutate, self.trials, self.goal)
        if middle is None:
            return
        self._divided.add(unit)
        for law in self.suggestions.following(Candidate(unit.mutations(self.mutate, middle), guard)):
            for one in stronger_and_weaker(law):
                if self._near(one, pair) and self._settled.holds(one, self.trials, self.goal, pair):
                    yield one
                    break

    def _learn(self, unit: Unit, candidate: Candidate, factor: float) -> None:
        pairs = self.goal.pairs
        gain, moved = self.trials.gain(candidate, self.goal), self.trials.moved(candidate, pairs)
        hollow = gain < PARTLY * self.goal.wanted and self.trials.fails_sooner(candidate, self.goal)
        self.gains.enter((unit, candidate.guard), factor, gain, moved, hollow=hollow)
        self._acting.ran(unit, candidate)

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a factor on a unit. Return the candidate if it was not tried before and is confirmed, else None."""
        candidate = Candidate(unit.mutations(self.mutate, factor), guard)
        if not candidate.mutations or candidate in self._tried:
            return None
        self._tried.add(candidate)
        near = self._near(candidate, pair)
        if near is None:
            return None
        holds = near and self._settled.holds(candidate, self.trials, self.goal, pair)
        self._learn(unit, candidate, factor)
        if holds:
            self.uses.learn(unit, guard, factor, pair)
        return candidate if holds else None

    def reaches(self, unit: Unit, factor: float, guard: Guard, pair: int, confirmable: bool = True) -> bool:
        """Try a factor on a pair's seed and return whether it reaches the goal. Return False if it was tried before."""
        candidate = Candidate(unit.mutations(self.mutate, factor), guard)
        if not candidate.mutations or candidate in self._tried:
            return False
        near = self._near(candidate, pair)
        if near is not None:
            self._learn(unit, candidate, factor)
        if not (near and confirmable):
            self._tried.add(candidate)
        return bool(near)

    def ran_on(self, unit: Unit, guard: Guard, factor: float) -> int:
        """Return the index of the pair on whose seed a change ran first; if it never ran, the current turn's pair."""
        return self._ran_on.get((unit, guard, factor), self.pair)

    def expect(self, tries: Iterable[tuple[Unit, Guard, float]], pair: int) -> None:
        """Announce the tries that come next unless a result changes the order."""
        seed = self.goal.pairs[pair].seed
        candidates = [Candidate(unit.mutations(self.mutate, factor), guard) for unit, guard, factor in tries]
        self.trials.expect((one, seed) for one in candidates if one.mutations and one not in self._tried)

    def _near(self, candidate: Candidate, pair: int) -> bool | None:
        """Run a candidate once; return whether it reached the goal, or None if it cannot be written."""
        try:
            seed = self.goal.pairs[pair].seed
            return self.trials.reaches(candidate, seed, self.goal)
        except RepairError:
            return None

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """Try factors between the best factor of a unit and the factors next to it."""
        yield from self.adjusting.between(best, pair)

    def joining(
        self, gains: Mapping[Unit, Mapping[float, float]], among: Sequence[Unit] | None = None
    ) -> ForwardSelection:
        """Return a selection that combines the units `among` (by default all units of the search)."""
        return ForwardSelection(
            self.units if among is None else among,
            self.mutate,
            self.trials,
            self.goal,
            gains,
            self.slack,
            self._settled,
            self._alone,
        )

    def _alone(self, candidate: Candidate, unit: Unit, factor: float) -> Iterator[Candidate]:
        """Yield the changes that are preferred to a single change that is left of a combination."""
        self._tried.add(candidate)
        self._learn(unit, candidate, factor)
        yield from self.preferences.before(candidate, unit, factor, 0, True, True)


def easy(goal: Goal) -> Sequence[int]:
    """Return the indices of the pairs that lost least; all indices if the drift's size varies.

    An easy pair lost at least `LOST`, because a gain on a pair that lost less cannot be told from noise. If the drift's
    size varies, the pairs are ordered so that they span the range of sizes.
    """
    every = range(len(goal.pairs))
    if goal.ranged:
        return every
    clear = [
        at
        for at in every
        if goal.enough_on([goal.pairs[at].seed]) - goal.pairs[at].total >= LOST * goal.wanted
    ]
    return sorted(clear or every, key=lambda at: -goal.pairs[at].total)[:EASY]
