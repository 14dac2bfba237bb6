"""Sweep and confirm, the default search: try one factor on all operands, then the next factor.

Each run is paired with the unmutated run of the same seed. A candidate that earns nearly the designed reward is tried
on further seeds. Results steer the search: larger steps are tried only on operands whose smaller step did not clearly
reduce the reward, best gain first. If no single operand suffices, the search combines those that gained.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.charts import Chart
from pytest_tarl.searching import plateau
from pytest_tarl.searching.acting import Acting
from pytest_tarl.searching.adjusting import Adjusting
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.combining import Combining
from pytest_tarl.searching.families import families
from pytest_tarl.searching.forward_selection import ForwardSelection, Settled
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.preferring import Preferences
from pytest_tarl.searching.refining import FURTHER
from pytest_tarl.searching.screening import blocks, screened, worth_screening
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import (
    NEAR,
    Scope,
    Unit,
    best_effects,
    charted,
    everywhere,
    units,
    uses_apart,
)
from pytest_tarl.searching.uses import Uses
from tarl_lint.model import Operand

if TYPE_CHECKING:
    import numpy as np

LEADING = 3  # number of best units that are tried with larger steps before the next guard is tried
HINT = 0.005  # minimum gain of the `LEADING` units, as a share of the loss
FLIP = -1.0  # factor that flips the sign
BETWEEN = (1.5, 0.65)
FINER = (1.22, 0.82)
FINE = (*FINER, 1.1, 0.91)  # factors for operands that change the reward but gain nothing with larger steps
# factors for named constants, if the `FINE` steps gain nothing either
BETWEEN_FINE = (1.16, 0.86, 1.05, 0.95, 1.35, 0.74)
LAST = (10.0, 0.05)
# maximum number of units to try with the other sign, among those that gained with a smaller value
FLIPPED = 3
HALF = 0.5  # gain of a change, as a share of the wanted gain, from which on others get no `FINER` steps
SLACK = 0.1  # gains and losses up to this share of the wanted gain count as noise


class Sweep:
    """Sweep and confirm: operands in the given order, each mutated at its use under one of the guards.

    If the first guard is `ALWAYS`, only this guard is used throughout, otherwise the first two are. The others are used
    only at the end. If `proposed` is true, the operands are parameters of a change that the program does not contain
    yet. Such parameters are first tried with their own values. If the change has no effect, factors that make
    it `weaker` are skipped. Only parameters of the same change are combined. The last steps of the sweep are
    tried on every operand. If a search for structural changes follows, only the nearest of these steps are
    tried, on named constants. `responding` contains the ids of statements whose constants increased the
    reward. `interlude` is called with the largest gain before each step and each long phase, and may yield
    candidates of another search.
    """

    def __init__(
        self,
        operands: Sequence[Operand],
        mutate: Mutate,
        guards: Sequence[Guard],
        trials: Trials,
        goal: Goal,
        generator: np.random.Generator | None = None,
        proposed: bool = False,
        late: Sequence[Operand] = (),
        aside: Sequence[Operand] = (),
        weaker: Callable[[Operand, float], bool] = lambda _, __: False,
        structure_follows: bool = False,
        charts: Mapping[Operand, Chart] = MappingProxyType({}),
        given: Callable[[Operand], Sequence[Operand]] = lambda _: (),
        responding: Collection[str] = (),
        scope: Scope = everywhere,
        interlude: Callable[[float], Iterator[Candidate]] = lambda _: iter(()),
    ) -> None:
        self.interlude = interlude
        self.responding = responding
        self.structure_follows = structure_follows
        self.late = units(late)
        self.aside = units(aside)
        self.scope = scope
        self.units = charted(units(operands), charts)
        parts: Mapping[Unit, tuple[Unit, ...]] = {}
        if not proposed:
            self.units, parts = uses_apart(self.units, (*self.late, *self.aside), scope)
        self.uses = Uses(self, parts)
        self.weaker = weaker
        self.given = given
        self.mutate = mutate
        self.guards = guards
        self.trials = trials
        self.goal = goal
        self.generator = generator
        self.slack = SLACK * goal.wanted
        self.proposed = proposed
        self._acting = Acting(trials, goal)
        self.gains = Gains(self.slack, proposed, None if proposed else self._acting)
        self._tried: set[Candidate] = set()
        self._settled = Settled()
        # units that were confirmed and yielded, but that the caller refused
        self.refused: set[tuple[Unit, Guard]] = set()
        self.preferences = Preferences(self)
        self.combining = Combining(self)
        self.adjusting = Adjusting(self)
        self._inside: set[Guard] = set()
        self._families: tuple[Unit, ...] = ()
        self._turn = 0

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates."""
        chief = self.guards[: 1 if not self.guards[0].conjuncts else 2]
        if self.generator is not None and worth_screening(self.units):
            self.units = yield from screened(self.joining({}), self.guards[0], self.generator)
        self._families = () if self.proposed else families(self.units)
        self.units = (*self.units, *self._families)
        yield from self._in_large_steps(chief)
        gained = self.gains.anything()
        if gained:
            yield from self.interlude(self.gains.best())
            yield from self.combining.sharpened(chief)
            yield from self.interlude(self.gains.best())
            yield from self.combining.jointly(chief)
            yield from self.combining.best_with_others()
        yield from self._finely(chief)
        if not gained:
            yield from self.combining.best_with_others()
        yield from self._late_ones((*self.aside, *self.late), chief)
        if self.structure_follows:
            for factor in BETWEEN:
                for guard in chief:
                    yield from self._all(factor, guard, named(self.units))
            return
        for factor in (*BETWEEN, *LAST, *NEAR, *(factor for factor, _ in FURTHER), FLIP):
            for guard in self.guards:
                among = self.gains.moving(self.units) if self.proposed else self.units
                yield from self._all(factor, guard, among)

    def _in_large_steps(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """Try every unit in steps that are large enough to show whether it matters."""
        for block in blocks(self.units):
            for guard in chief:
                yield from self._near_ones(block, guard)
        for factor, before in FURTHER:
            for guard in chief:
                leading = self._leading(before, guard, -self.slack)
                still = [unit for unit in self._families if unit not in leading]
                yield from self._all(factor, guard, [*leading, *still])
                yield from self._inward(guard)
                yield from self.adjusting.exactly(guard)
                yield from self.combining.leaders(guard)
        if not self.gains.anything():
            yield from self._late_ones(self.aside, chief)
            yield from self._across_a_plateau(chief[0], plateau.STEPS)
        for factor in (*BETWEEN, FLIP):
            for guard in chief:
                yield from self._all(factor, guard, self.gains.moving(self.units))

    def _across_a_plateau(self, guard: Guard, steps: Sequence[plateau.Step]) -> Iterator[Candidate]:
        """Try the steps of `plateau` under a guard while no unit gains reward."""
        for factor, before in () if self.proposed else steps:
            if self.gains.anything():
                return
            yield from self._all(factor, guard, plateau.among(before, self.units, self.gains, guard))

    def _inward(self, guard: Guard) -> Iterator[Candidate]:
        """Try inward steps (see `plateau`) once under a guard while a large change gains most."""
        if self.proposed or guard in self._inside or not plateau.best_is_far(self.gains, guard):
            return
        self._inside.add(guard)
        matter, steps = plateau.inward(self.units, self.gains)
        for factor in steps:
            if not plateau.best_is_far(self.gains, guard):
                return
            yield from self._all(factor, guard, matter)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, for each site, the gain of each operand's best value over the unmutated runs of the same seeds."""
        return best_effects([(unit, gains) for (unit, _), gains in self.gains.items()], self.mutate)

    def _near_ones(self, block: Sequence[Unit], guard: Guard) -> Iterator[Candidate]:
        """Increase and decrease each unit, then try smaller steps if both lose, and combine the best units.

        Until a gain exceeds the slack, the `LEADING` best units get larger steps at once.
        """
        moving = self.gains.moving(block)
        yield from self._carried_over(guard)
        if self.proposed:
            yield from self._all(1.0, guard, moving)
            yield from self._strengthened(guard, moving)
            yield from self._all(FLIP, guard, moving)
        else:
            yield from self._named_first(guard, named(moving))
        for factor in NEAR:
            yield from self._all(factor, guard, moving)
        yield from self._across_a_plateau(guard, plateau.STEPS[:2])
        yield from self._narrow(guard, moving)
        for factor, before in () if self.gains.anything() else FURTHER:
            leading = self._leading(before, guard, self.goal.wanted * HINT)
            yield from self._all(factor, guard, leading[:LEADING])
        yield from self._without_condition(guard)
        yield from self._inward(guard)
        yield from self.adjusting.exactly(guard)
        yield from self.combining.leaders(guard)
        yield from self.combining.unmasked(guard)
        yield from self._uses_apart(guard, block)

    def _named_first(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Increase named constants; if none gains, try moderate steps on them before other constants are tried."""
        yield from self._each(NEAR[0], guard, among, self._turn % len(self.goal.pairs))
        if among and not self.gains.anything():
            self._turn += 1
            yield from self._all(NEAR[1], guard, among)
            yield from self._across_a_plateau(guard, plateau.STEPS[:2])

    def _uses_apart(self, guard: Guard, block: Sequence[Unit]) -> Iterator[Candidate]:
        """Change a constant at one of its uses only, because its effects at several uses may cancel each other."""
        uses = [use for whole in self.gains.moving(block) for use in self.uses.of(whole)]
        self.units = (*self.units, *(use for use in uses if use not in self.units))
        for factor in NEAR if uses else ():
            yield from self._all(factor, guard, self.gains.moving(uses))

    def _strengthened(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Strengthen proposals too weak to have an effect; use the largest factors only at statements that respond."""
        for factor in (*NEAR, *(factor for factor, _ in FURTHER)):
            idle = [unit for unit in among if self.gains.idle(unit)]
            if factor not in NEAR:
                idle = [unit for unit in idle if str(unit.operands[0].site) in self.responding]
            yield from self._all(factor, guard, idle) if idle else ()

    def _carried_over(self, guard: Guard) -> Iterator[Candidate]:
        """Try the best units of other guards under this guard, because those guards may be too narrow."""
        pair = self._turn % len(self.goal.pairs)
        for unit, factor in self.gains.best_under([one for one in self.guards if one != guard])[:LEADING]:
            yield from self.attempt(unit, guard, factor, pair)

    def _without_condition(self, guard: Guard) -> Iterator[Candidate]:
        """Try the change that gains most without its condition before more is done under it: it may be too narrow."""
        for unit, factor in self.gains.best_under([guard])[:1]:
            if guard.conjuncts and ALWAYS in self.guards and self.gains.most((unit, guard)) > self.slack:
                yield from self.attempt(unit, ALWAYS, factor, self._turn % len(self.goal.pairs))

    def _all(self, factor: float, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try one factor on several operands, then refine the best one."""
        yield from self.interlude(self.gains.best())
        pair = self._turn % len(self.goal.pairs)
        self._turn += 1
        yield from self._each(factor, guard, among, pair)
        if 0.0 < factor < 1.0:
            for unit in self._leading(factor, guard, self.slack)[:FLIPPED]:
                yield from self.attempt(unit, guard, FLIP, pair)
        yield from self.adjusting.refine(pair)

    def _each(self, factor: float, guard: Guard, among: Sequence[Unit], pair: int) -> Iterator[Candidate]:
        among = self.gains.distinct(among)
        for at, unit in enumerate(among):
            self.expect([(each, guard, factor) for each in among[at:]], pair)
            yield from self.attempt(unit, guard, factor, pair)

    def _late_ones(self, late: Sequence[Unit], guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try operands that are in no data flow, such as the period of a timer."""
        new = [unit for unit in late if unit not in self.units]
        self.units = (*self.units, *new)
        for guard in guards if new else ():
            yield from self._near_ones(new, guard)

    def _narrow(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try smaller steps on operands for which both near factors lost: their best values must be close.

        If the smaller steps lose as well and nothing else is promising, try the `FINER` steps.
        """
        lost = self.gains.lost_both_ways(guard, among, NEAR)
        for factor in BETWEEN if lost else ():
            yield from self._all(factor, guard, lost)
        promising = self.gains.anything(HALF * self.goal.wanted)
        still = [] if promising else self.gains.lost_both_ways(guard, lost, BETWEEN)
        for factor in FINER if still else ():
            yield from self._all(factor, guard, still)

    def _finely(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try small steps on operands that change the reward and were not refined: only a few values may be good.

        If no step gains, try the steps between these on named constants.
        """
        for factor in (*FINE, *BETWEEN_FINE):
            if factor in BETWEEN_FINE and self.gains.anything():
                return
            among = self.units if factor in FINE else named(self.units)
            for guard in guards:
                moved = [unit for unit in self.gains.moving(among) if self.gains.matters(unit)]
                yield from self._all(
                    factor, guard, [unit for unit in moved if not self.adjusting.refined[unit, guard]]
                )

    def _leading(self, before: float, guard: Guard, least: float) -> list[Unit]:
        return self.gains.leading(before, guard, self.units, least)

    def attempt(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        """Try a factor; if the candidate is confirmed, yield the changes preferred to it, then the candidate."""
        mutations = unit.mutations(self.mutate, factor)
        candidate = Candidate(mutations, guard)
        if not mutations or candidate in self._tried:
            return
        if self.gains.idle(unit) and self.weaker(unit.operands[0], factor):
            return
        self._tried.add(candidate)
        near = self._near(candidate, pair)
        if near is None:
            return
        self._learn(unit, candidate, factor)
        holds = near and self._settled.holds(candidate, self.trials, self.goal, pair)
        self._learn(unit, candidate, factor)
        yield from self.preferences.before(candidate, unit, factor, pair, holds, near)
        if holds:
            self.uses.learn(unit, guard, factor, pair)
            yield candidate
            yield from self.preferences.after()
        elif near:
            yield from self.uses.alone(unit, guard, factor, pair)
        if holds or (near and self.trials.loses(candidate)):
            self.refused.add((unit, guard))

    def _learn(self, unit: Unit, candidate: Candidate, factor: float) -> None:
        pairs = self.goal.pairs
        gain, moved = self.trials.gain(candidate, pairs), self.trials.moved(candidate, pairs)
        self.gains.enter((unit, candidate.guard), factor, gain, moved)
        self._acting.ran(unit, candidate)

    def holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a factor; return the candidate if it is new and confirmed, else None."""
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
        """Return whether a new factor reaches the goal on a pair's seed; `confirmable` ones may be confirmed later."""
        candidate = Candidate(unit.mutations(self.mutate, factor), guard)
        if not candidate.mutations or candidate in self._tried:
            return False
        near = self._near(candidate, pair)
        if near is not None:
            self._learn(unit, candidate, factor)
        if not (near and confirmable):
            self._tried.add(candidate)
        return bool(near)

    def expect(self, tries: Iterable[tuple[Unit, Guard, float]], pair: int) -> None:
        """Announce the tries that come next unless a result changes the order."""
        seed = self.goal.pairs[pair].seed
        candidates = [Candidate(unit.mutations(self.mutate, factor), guard) for unit, guard, factor in tries]
        self.trials.expect((one, seed) for one in candidates if one.mutations and one not in self._tried)

    def _near(self, candidate: Candidate, pair: int) -> bool | None:
        """Run a candidate once; return whether it reached the goal, or None if it cannot be written into the source."""
        try:
            seed = self.goal.pairs[pair].seed
            return self.goal.reached(self.trials(candidate, seed), seed)
        except RepairError:
            return None

    def between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """Try factors between the unit's best factor and its neighbours."""
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
        """Yield the changes preferred to a single change that was found as part of a combination."""
        self._tried.add(candidate)
        self._learn(unit, candidate, factor)
        yield from self.preferences.before(candidate, unit, factor, 0, True, True)
