"""Sweep and confirm, the default search: try one factor on all operands, then the next factor.

Each run is paired with the unmutated run of the same seed. A candidate that earns nearly the designed reward is tried
on further seeds. Results steer the search: larger steps are tried only on operands whose smaller step did not clearly
reduce the reward, best gain first. If no single operand suffices, the search combines those that gained.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.charts import Chart
from pytest_tarl.searching import plateau
from pytest_tarl.searching.calls_apart import calls_of
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.closeness import CLOSER, COMPARED, EXACT, RIVALS, rivals
from pytest_tarl.searching.families import families
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint, Settled
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.gentler import another_way, gentler
from pytest_tarl.searching.jointly import LEAST, Jointly, sensitive
from pytest_tarl.searching.plainness import Oddness, named, oddness, plainer, writing
from pytest_tarl.searching.refining import ALMOST, PROMISING, between
from pytest_tarl.searching.screening import blocks, screened, worth_screening
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.smaller import BESIDE, EARLY, EPISODES, WORSE, smaller
from pytest_tarl.searching.units import NEAR, Unit, best_effects, charted, units, whole_constants
from pytest_tarl.searching.unmasking import GAINED, longer, unmasked
from tarl_lint.model import Operand

if TYPE_CHECKING:
    import numpy as np

FURTHER = ((5.0, 2.2), (0.15, 0.4))  # (larger step, smaller step that must not have reduced the reward)
LEADING = 3  # number of best units that get larger steps before the next guard is tried
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
REFINEMENTS = 3  # maximum number of consecutive refinements of one operand that gains `PROMISING`
REFINED = 8  # maximum number of runs that refine one operand
# number of refinements of each constant whose change a maintainer would prefer to the candidate found
PLAINER_ROUNDS = 2
PLAINER = 12  # maximum number of runs for all such constants
SLACK = 0.1  # gains and losses up to this share of the wanted gain count as noise


class Sweep:
    """Sweep and confirm: operands in the given order, each mutated at its use under one of the guards.

    If the first guard is `ALWAYS`, only this guard is used throughout, otherwise the first two are. The others are used
    only at the end. If `proposed` is true, the operands are parameters of a change that the program does not contain
    yet. They are first tried with their own values. If the change has no effect, factors that make it `weaker` are
    skipped. Only parameters of the same change are combined. The last steps of the sweep are tried on every operand. If
    a search for structural changes follows, only the nearest of these steps are tried, on named constants.
    `responding` contains the ids of statements whose constants increased the reward.
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
    ) -> None:
        self.responding = responding
        self.structure_follows = structure_follows
        self.units = charted(units(operands), charts)
        self.late = units(late)
        self.aside = units(aside)
        self.weaker = weaker
        self.given = given
        self.mutate = mutate
        self.guards = guards
        self.trials = trials
        self.goal = goal
        self.generator = generator
        self.slack = SLACK * goal.wanted
        self.proposed = proposed
        self._gains = Gains(self.slack, proposed)
        self._tried: set[Candidate] = set()
        self._settled = Settled()
        self._refined: Counter[tuple[Unit, Guard]] = Counter()
        self._refused: set[tuple[Unit, Guard]] = set()  # confirmed and yielded, then refused by the caller
        self._compared = (
            False  # whether rival constants were already compared by the course of their missions
        )
        self._reduced = False  # whether smaller changes of other constants were already tried
        self._replaced: set[Unit] = set()  # units that were already compared with milder changes
        self._adjusted: set[tuple[Unit, Guard, float]] = set()
        self._unmasked_under: set[tuple[Unit, Guard]] = set()
        self._families: tuple[Unit, ...] = ()
        self._turn = 0

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates."""
        chief = self.guards[: 1 if not self.guards[0].conjuncts else 2]
        if self.generator is not None and worth_screening(self.units):
            self.units = yield from screened(self._joining({}), self.guards[0], self.generator)
        self._families = () if self.proposed else families(self.units)
        self.units = (*self.units, *self._families)
        yield from self._in_large_steps(chief)
        gained = self._gains.anything()
        if gained:
            yield from self._sharpened(chief)
            yield from self._jointly(chief)
            yield from self._together()
        yield from self._finely(chief)
        if not gained:
            yield from self._together()
        yield from self._late_ones((*self.aside, *self.late), chief)
        if self.structure_follows:
            for factor in BETWEEN:
                for guard in chief:
                    yield from self._all(factor, guard, named(self.units))
            return
        for factor in (*BETWEEN, *LAST, *NEAR, *(factor for factor, _ in FURTHER), FLIP):
            for guard in self.guards:
                among = self._gains.moving(self.units) if self.proposed else self.units
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
                yield from self._leaders_together(guard)
        if not self._gains.anything():
            yield from self._late_ones(self.aside, chief)
            yield from self._across_a_plateau(chief)
        for factor in (*BETWEEN, FLIP):
            for guard in chief:
                yield from self._all(factor, guard, self._gains.moving(self.units))

    def _across_a_plateau(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """Try the steps of `plateau` under the first guard while nothing gains."""
        guard = chief[0]
        for factor, before in () if self.proposed else plateau.STEPS:
            if self._gains.anything():
                return
            yield from self._all(factor, guard, plateau.among(before, self.units, self._gains, guard))

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, for each site, the gain of each operand's best value over the unmutated runs of the same seeds."""
        return best_effects([(unit, gains) for (unit, _), gains in self._gains.items()], self.mutate)

    def _near_ones(self, block: Sequence[Unit], guard: Guard) -> Iterator[Candidate]:
        """Increase and decrease each unit, then try smaller steps if both lose, and combine the best units.

        Until a gain exceeds the slack, the `LEADING` best units get larger steps at once.
        """
        moving = self._gains.moving(block)
        yield from self._carried_over(guard)
        if self.proposed:
            yield from self._all(1.0, guard, moving)
            yield from self._strengthened(guard, moving)
        for factor in (FLIP, *NEAR) if self.proposed else NEAR:
            yield from self._all(factor, guard, moving)
        yield from self._narrow(guard, moving)
        for factor, before in () if self._gains.anything() else FURTHER:
            leading = self._leading(before, guard, self.goal.wanted * HINT)
            yield from self._all(factor, guard, leading[:LEADING])
        yield from self._leaders_together(guard)
        yield from self._unmasked(guard)

    def _strengthened(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Make proposals stronger that were too weak to have an effect, most of all at statements that respond."""
        for factor in (*NEAR, *(factor for factor, _ in FURTHER)):
            idle = [unit for unit in among if self._gains.idle(unit)]
            if factor not in NEAR:
                idle = [unit for unit in idle if str(unit.operands[0].site) in self.responding]
            yield from self._all(factor, guard, idle) if idle else ()

    def _carried_over(self, guard: Guard) -> Iterator[Candidate]:
        """Try the best units of other guards under this guard, because those guards may be too narrow."""
        pair = self._turn % len(self.goal.pairs)
        for unit, factor in self._gains.best_under([one for one in self.guards if one != guard])[:LEADING]:
            yield from self._try(unit, guard, factor, pair)

    def _all(self, factor: float, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try one factor on several operands, then refine the best one."""
        pair = self._turn % len(self.goal.pairs)
        self._turn += 1
        among = self._gains.distinct(among)
        for at, unit in enumerate(among):
            self._expect([(each, guard, factor) for each in among[at:]], pair)
            yield from self._try(unit, guard, factor, pair)
        if 0.0 < factor < 1.0:
            for unit in self._leading(factor, guard, self.slack)[:FLIPPED]:
                yield from self._try(unit, guard, FLIP, pair)
        yield from self._refine(pair)

    def _late_ones(self, late: Sequence[Unit], guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try operands that are in no data flow, such as the period of a timer."""
        new = [unit for unit in late if unit not in self.units]
        self.units = (*self.units, *new)
        for guard in guards if new else ():
            yield from self._near_ones(new, guard)

    def _narrow(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try smaller steps on operands for which both near factors lost: their best values must be close.

        If the smaller steps lose as well and nothing else gained, try the `FINER` steps.
        """
        lost = self._gains.lost_both_ways(guard, among, NEAR)
        for factor in BETWEEN if lost else ():
            yield from self._all(factor, guard, lost)
        still = [] if self._gains.anything() else self._gains.lost_both_ways(guard, lost, BETWEEN)
        for factor in FINER if still else ():
            yield from self._all(factor, guard, still)

    def _finely(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try small steps on operands that change the reward and were not refined: only a few values may be good.

        If no step gains, try the steps between these on named constants.
        """
        for factor in (*FINE, *BETWEEN_FINE):
            if factor in BETWEEN_FINE and self._gains.anything():
                return
            among = self.units if factor in FINE else named(self.units)
            for guard in guards:
                moved = [unit for unit in self._gains.moving(among) if self._gains.moves(unit)]
                yield from self._all(
                    factor, guard, [unit for unit in moved if not self._refined[unit, guard]]
                )

    def _leading(self, before: float, guard: Guard, least: float) -> list[Unit]:
        return self._gains.leading(before, guard, self.units, least)

    def _try(self, unit: Unit, guard: Guard, factor: float, pair: int) -> Iterator[Candidate]:
        mutations = unit.mutations(self.mutate, factor)
        candidate = Candidate(mutations, guard)
        if not mutations or candidate in self._tried:
            return
        if self._gains.idle(unit) and self.weaker(unit.operands[0], factor):
            return
        self._tried.add(candidate)
        near = self._near(candidate, pair)
        if near is None:
            return
        self._learn(unit, candidate, factor)
        holds = near and self._settled.holds(candidate, self.trials, self.goal, pair)
        self._learn(unit, candidate, factor)
        if holds:
            yield from self._plainer(candidate, unit, pair)
            yield from self._called(candidate, unit, factor)
        if holds or (near and oddness(candidate.mutations) is Oddness.NATURE):
            yield from self._instead(candidate, unit, pair)
        if holds:
            yield from self._truer(candidate, unit, factor, pair)
            yield from self._smaller(candidate, unit, factor, pair)
            yield candidate
        if holds or (near and self.trials.loses(candidate)):
            self._refused.add((unit, guard))

    def _learn(self, unit: Unit, candidate: Candidate, factor: float) -> None:
        pairs = self.goal.pairs
        gain, moved = self.trials.gain(candidate, pairs), self.trials.moved(candidate, pairs)
        self._gains.enter((unit, candidate.guard), factor, gain, moved)

    def _plainer(self, found: Candidate, unit: Unit, pair: int) -> Iterator[Candidate]:
        """Spend a few episodes on changes that a maintainer would prefer to the candidate found.

        If the candidate changes a literal, named constants also get larger steps, because small steps may have no
        effect.
        """
        odd, guard, begun = oddness(found.mutations), found.guard, self.trials.spent
        # If the candidate is an offset, also refine units that were refused before.
        before = set(self._refused if odd is Oddness.OFFSET else ())
        others = [one for one in self.units if one != unit]
        gains = self._gains.under(guard)
        for other in plainer(odd, gains, others, PROMISING * self.goal.wanted, unit):
            held = guard
            for factor in NEAR if other not in gains else ():
                yield from self._try(other, guard, factor, pair)
            if not self._gains.of(other, guard) and ALWAYS in self.guards:
                # the condition cannot be written at this place, for example in a helper function
                held = ALWAYS
                for factor in NEAR:
                    yield from self._try(other, held, factor, pair)
            yield from self._closer(other, held, before, pair)
            if self.trials.spent - begun >= PLAINER:
                return
        for factor, nearer in FURTHER if odd is Oddness.INNER else ():
            for other in self._gains.leading(nearer, guard, named(others), -self.slack, inert=True):
                if self.trials.spent - begun < PLAINER:
                    yield from self._try(other, guard, factor, pair)
                    yield from self._closer(other, guard, before, pair)

    def _called(self, found: Candidate, unit: Unit, factor: float) -> Iterator[Candidate]:
        """If a candidate changes a function's return value, instead change as few calls of the function as suffice."""
        calls = calls_of(unit, self.units)
        if len(calls) > 1:
            joint = Joint(tuple((call, factor) for call in calls), found.guard)
            yield from self._joining({}).fewest(joint)

    def _instead(self, found: Candidate, unit: Unit, pair: int) -> Iterator[Candidate]:
        """If missions do not proceed as designed with the candidate, first try small steps of named constants."""
        if unit in self._replaced or not another_way(found, self.trials, self.goal):
            return
        self._replaced.add(unit)
        begun, promising = self.trials.spent, PROMISING * self.goal.wanted
        for other, steps in gentler(unit, self.units, self._gains, found.guard, promising):
            for step in steps:
                if self.trials.spent - begun < PLAINER:
                    yield from self._try(other, found.guard, step, pair)

    def _truer(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """Yield a rival constant first if its missions are much closer to the designed ones.

        It is then more likely to be the cause.
        """
        seeds = self._compared_on(pair)
        if self._compared or self._deviation(found, seeds[:1]) <= EXACT:
            return
        self._compared = True
        begun = self.trials.spent
        for other, step in rivals(unit, factor, self.units, self._gains, found.guard):
            if self.trials.spent - begun >= RIVALS:
                return
            candidate = self._holding(other, step, found.guard, pair)
            if candidate is None:
                continue
            if self._deviation(candidate, seeds) <= CLOSER * self._deviation(found, seeds):
                yield candidate
                self._refused.add((other, found.guard))
                return

    def _smaller(self, found: Candidate, unit: Unit, factor: float, pair: int) -> Iterator[Candidate]:
        """Yield a much smaller change of another constant first, unless missions then deviate more from the design."""
        if self._reduced or self.proposed or self.trials.spent > EARLY * self.trials.budget:
            return
        parts = smaller(unit, factor, self.units, self._gains, found.guard)
        self._reduced = bool(parts)
        begun, seeds = self.trials.spent, self._compared_on(pair)
        for other, step in parts:
            if self.trials.spent - begun >= EPISODES:
                return
            candidate = self._smaller_holding(other, step, found.guard, pair)
            if candidate is None:
                continue
            if self._deviation(candidate, seeds) <= self._deviation(found, seeds) + WORSE:
                yield candidate
                self._refused.add((other, found.guard))
                return

    def _smaller_holding(self, unit: Unit, step: float, guard: Guard, pair: int) -> Candidate | None:
        """Try a small step, and those beside it if it earns nearly enough; return the first candidate that holds."""
        if (unit, guard) in self._refused:
            return None
        candidate = self._holding(unit, step, guard, pair)
        gains = self._gains.of(unit, guard)
        if candidate is not None or gains.get(step, 0.0) < ALMOST * self.goal.wanted:
            return candidate
        tried = (self._holding(unit, round(step * by, 3), guard, pair) for by in BESIDE)
        return next((one for one in tried if one is not None), None)

    def _compared_on(self, pair: int) -> list[int]:
        """Return the seeds on which to compare the course of missions."""
        return [self.goal.pairs[(pair + i) % len(self.goal.pairs)].seed for i in range(COMPARED)]

    def _holding(self, unit: Unit, factor: float, guard: Guard, pair: int) -> Candidate | None:
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
        return candidate if holds else None

    def _deviation(self, candidate: Candidate, seeds: Sequence[int]) -> float:
        """Return the deviation of a candidate's missions from the designed ones, or 0 if it is unknown."""
        try:
            return self.trials.deviation(candidate, seeds)
        except RepairError:
            return 0.0

    def _closer(
        self, unit: Unit, guard: Guard, closed_before: set[tuple[Unit, Guard]], pair: int
    ) -> Iterator[Candidate]:
        """Refine a unit for `PLAINER_ROUNDS` rounds while it gains at least `PROMISING` and was not refused."""
        for _ in range(PLAINER_ROUNDS):
            closed = (unit, guard) in self._refused - closed_before
            if self._gains.most((unit, guard)) >= PROMISING * self.goal.wanted and not closed:
                yield from self._between((unit, guard), pair)

    def _expect(self, tries: Iterable[tuple[Unit, Guard, float]], pair: int) -> None:
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

    def _refine(self, pair: int) -> Iterator[Candidate]:
        """Refine the best operand while its gain approaches the wanted gain.

        Tiny gains are not refined, because a mission that fails slightly later does not indicate the right value.
        """
        for _ in range(REFINEMENTS):
            open_to = [
                tried
                for tried, _ in self._gains.items()
                if self._refined[tried] < _refinements(tried[0]) and tried not in self._refused
            ]
            best = max(open_to, key=self._gains.most, default=None)
            before = self._gains.most(best) if best is not None else 0.0
            if best is None or before <= self.slack:
                return
            yield from self._adjusting(*best)
            yield from self._between(best, pair)
            gained = self._gains.most(best)
            if gained <= max(before, PROMISING * self.goal.wanted) and gained < ALMOST * self.goal.wanted:
                return

    def _between(self, best: tuple[Unit, Guard], pair: int) -> Iterator[Candidate]:
        """Try factors between the operand's best factor and the neighbouring factors, on a log scale."""
        # A negative factor corrects the sign and needs no refinement, except for proposed values.
        gains = {one: gain for one, gain in self._gains.of(*best).items() if one > 0 or self.proposed}
        steps = between(gains, self.goal.wanted)
        self._expect([(*best, one) for one in steps], pair)
        for one in steps:
            self._refined[best] += 1
            yield from self._try(*best, one, pair)

    def _adjusting(self, unit: Unit, guard: Guard) -> Iterator[Candidate]:
        """Vary the fixed parameters of a proposal, such as a sensor's usual value, if the proposal gains much."""
        gains = self._gains.of(unit, guard)
        factor = max(gains, key=gains.__getitem__)
        given = self.given(unit.operands[0]) if self.proposed else ()
        if (unit, guard, factor) in self._adjusted or gains[factor] < PROMISING * self.goal.wanted:
            return
        self._adjusted.add((unit, guard, factor))
        for other in given:
            base = Joint(((unit, factor),), guard)
            yield from self._joining({}).climbed(base, Unit((other,)))

    def _together(self) -> Iterator[Candidate]:
        """Combine the best operand with others."""
        every = [
            (gain, *key, factor)
            for key, gains in self._gains.items()
            if key not in self._refused
            for factor, gain in gains.items()
        ]
        gain, unit, guard, factor = max(every, key=lambda one: one[0], default=(0.0, None, None, 1.0))
        if unit is None or guard is None or gain <= self.slack:
            return
        among = [
            one for one in self.units if not self.proposed or one.operands[0].span == unit.operands[0].span
        ]
        joining = self._joining(self._gains.under(guard), among)
        yield from joining.candidates(Joint(((unit, factor),), guard))

    def _jointly(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """Jointly search the constants that change missions most, starting at the best points so far."""
        if self.generator is None or self.proposed:
            return
        guard = max(chief, key=lambda one: max((gain for gain, _ in self._gains.leaders(one)), default=0.0))
        united = whole_constants((*self.units, *self.late))
        chosen, hidden = sensitive(united, self._gains, guard)
        if len(chosen) < LEAST:
            return
        joining = self._joining({})
        jointly = Jointly(chosen, joining, self.trials, self.goal, self.generator, hidden)
        leaders = [part for _, part in self._gains.leaders(guard) if part[0] in chosen and part[1] > 0]
        yield from jointly.candidates([Joint((part,), guard) for part in leaders[:LEADING]], guard)

    def _leaders_together(self, guard: Guard) -> Iterator[Candidate]:
        """Combine the best operands of different sites, each with its best factor, assuming additive main effects.

        This runs before refused operands are refined further, so combinations come before near-duplicates.
        """
        self._refused -= {tried for tried in self._refused if tried[1] == guard}
        leaders = self._gains.leaders(guard)
        if leaders and leaders[0][0] > self.slack and not self.proposed:
            hidden = [unit for unit in self.units if not self._gains.moves(unit)]
            yield from self._joining({}).unions([part for _, part in leaders], guard, hidden)

    def _sharpened(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """Adjust the best unit of each guard in small steps, before it is combined with others."""
        for guard in () if self.proposed else chief:
            for _, (unit, factor) in self._gains.leaders(guard)[:1]:
                yield from self._joining({}).sharpened(unit, factor, guard)

    def _unmasked(self, guard: Guard) -> Iterator[Candidate]:
        """Try the units without an effect once more, under the best unit, if its missions last longer."""
        leaders = self._gains.leaders(guard)
        if self.proposed or not leaders or leaders[0][0] < GAINED * self.goal.wanted:
            return
        unit, factor = leaders[0][1]
        base, joining = Joint(((unit, factor),), guard), self._joining({})
        if (unit, guard) in self._unmasked_under or not longer(base, joining):
            return
        self._unmasked_under.add((unit, guard))
        hidden = [one for one in self.units if not self._gains.moves(one) and one.operands != unit.operands]
        yield from unmasked(base, hidden, joining)

    def _joining(
        self, gains: Mapping[Unit, Mapping[float, float]], among: Sequence[Unit] | None = None
    ) -> ForwardSelection:
        return ForwardSelection(
            self.units if among is None else among,
            self.mutate,
            self.trials,
            self.goal,
            gains,
            self.slack,
            self._settled,
        )


def _refinements(unit: Unit) -> int:
    """Return the number of refining runs allowed for a unit; half of `REFINED` for an offset of a literal zero."""
    return REFINED // 2 if writing(unit.operands[0]) is Oddness.OFFSET else REFINED
