"""The default search, sweep and confirm: try one factor on all operands, then the next factor.

Each run is compared with the unmutated run of the same seed. A candidate that earns nearly the designed reward is tried
on further seeds. Earlier results steer the search: larger steps are tried only on operands whose smaller step did not
clearly reduce the reward, best gain first. If no single operand suffices, the search combines operands that gained.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.patching.charts import Chart
from pytest_tarl.searching import plateau
from pytest_tarl.searching.attempts import FLIP, Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.crossing import Crossing
from pytest_tarl.searching.families import families
from pytest_tarl.searching.first_steps import BETWEEN, FINER, HALF, FirstSteps
from pytest_tarl.searching.plainness import named
from pytest_tarl.searching.refining import FURTHER
from pytest_tarl.searching.screening import BLOCK, blocks, screened, worth_screening
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.suggestions import NO_SUGGESTIONS, Suggestions
from pytest_tarl.searching.twins import twins
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
from tarl_lint.model import Operand

if TYPE_CHECKING:
    import numpy as np

FINE = (*FINER, 1.1, 0.91)  # factors for operands that change the reward but gain nothing with larger steps
# factors for named constants, used if the `FINE` steps gain nothing either
BETWEEN_FINE = (1.16, 0.86, 1.05, 0.95, 1.35, 0.74)
LAST = (10.0, 0.05)
BRIEFLY = 0.3  # a brief search continues if a change gains at least this share of the wanted gain


class Sweep:
    """Sweep and confirm: mutate each operand at its use under one of the guards, in the given order.

    If the first guard is `ALWAYS`, all steps use it; otherwise they use the first two guards. Further guards are used
    only at the end.

    If `proposed` is true, the operands are parameters of a change that the program does not contain yet. Such
    parameters are first tried with their own values. If the change has no effect, factors that make it `weaker` are
    skipped. Parameters of different changes are not combined.

    The last steps of the sweep are tried on every operand. If a search for structural changes follows, only the nearest
    of these steps are tried, and only on named constants. If `brief` is true, the search ends after the first steps,
    except if something gains at least `BRIEFLY`. `responding` contains the ids of statements whose constants increased
    the reward.

    `finer` is called with an operand that nearly earned enough; `mutate` may then allow values between those of the
    operand's grid.
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
        brief: bool = False,
        charts: Mapping[Operand, Chart] = MappingProxyType({}),
        given: Callable[[Operand], Sequence[Operand]] = lambda _: (),
        finer: Callable[[Operand], object] = lambda _: None,
        responding: Collection[str] = (),
        scope: Scope = everywhere,
        suggestions: Suggestions = NO_SUGGESTIONS,
    ) -> None:
        self.structure_follows = structure_follows
        self.brief = brief
        self.aside = units(aside)
        behind = units(late)
        searched = charted(units(operands), charts)
        parts: Mapping[Unit, tuple[Unit, ...]] = {}
        if not proposed:
            searched, parts = uses_apart(searched, (*behind, *self.aside), scope)
        self.attempts = Attempts(
            searched,
            mutate,
            guards,
            trials,
            goal,
            parts=parts,
            late=behind,
            generator=generator,
            proposed=proposed,
            weaker=weaker,
            given=given,
            finer=finer,
            scope=scope,
            suggestions=suggestions,
        )
        self.crossing = Crossing(self.attempts)
        self.first_steps = FirstSteps(self.attempts, self.crossing, operands, responding)
        self._families: tuple[Unit, ...] = ()
        # units that already got their first steps before the screening
        self._swept: frozenset[Unit] = frozenset()

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates."""
        tries, gains = self.attempts, self.attempts.gains
        chief = tries.guards[: 1 if not tries.guards[0].conjuncts else 2]
        if tries.generator is not None and worth_screening(tries.units):
            yield from self._before_screening(chief)
        if tries.generator is not None and worth_screening(self._unswept()):
            order = yield from screened(tries.joining({}, self._unswept()), tries.guards[0], tries.generator)
            tries.units = (*(unit for unit in tries.units if unit in self._swept), *order)
        self._families = () if tries.proposed else families(tries.units)
        tries.twins = () if tries.proposed else twins(tries.units)
        tries.units = (*tries.units, *self._families)
        yield from self._in_large_steps(chief)
        gained = gains.anything()
        if self._ends():
            return
        if gained:
            yield from tries.interlude(gains.best())
            yield from tries.combining.sharpened(chief)
            yield from tries.interlude(gains.best())
            yield from tries.combining.jointly(chief)
            yield from tries.combining.best_with_others()
        yield from self._finely(chief)
        if not gained:
            yield from tries.combining.best_with_others()
        yield from self._late_ones((*self.aside, *tries.late), chief)
        if self.structure_follows:
            for factor in BETWEEN:
                for guard in chief:
                    yield from tries.sweep(factor, guard, named(tries.units))
            return
        for factor in (*BETWEEN, *LAST, *NEAR, *(factor for factor, _ in FURTHER), FLIP):
            for guard in tries.guards:
                among = gains.moving(tries.units) if tries.proposed else tries.units
                yield from tries.sweep(factor, guard, among)

    def _ends(self) -> bool:
        """Return whether a brief search ends after its first steps."""
        tries = self.attempts
        return self.brief and not tries.gains.anything(BRIEFLY * tries.goal.wanted)

    def _before_screening(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """If there are few named constants, try them first: a maintainer would rather change them than a literal.

        While all failing missions earn the same, a screening learns nothing. Finer steps on a few named constants then
        cost less than first steps on many literals.
        """
        tries = self.attempts
        every, few = tries.units, named(tries.units)
        if not 0 < len(few) <= BLOCK:
            return
        tries.units = tuple(few)
        for guard in chief:
            yield from self.first_steps.near(few, guard)
        yield from self.crossing.of_few(chief[0], few)
        self._swept = frozenset(tries.units)
        tries.units = (*tries.units, *(unit for unit in every if unit not in self._swept))

    def _unswept(self) -> tuple[Unit, ...]:
        return tuple(unit for unit in self.attempts.units if unit not in self._swept)

    def _in_large_steps(self, chief: Sequence[Guard]) -> Iterator[Candidate]:
        """Try every unit in steps that are large enough to show whether it matters."""
        tries, gains = self.attempts, self.attempts.gains
        conditional = not tries.proposed and len(chief) > 1 and ALWAYS in tries.guards
        if conditional:
            yield from self.first_steps.everywhere(self._unswept())
            if gains.anything(HALF * tries.goal.wanted):
                chief = (ALWAYS, *(guard for guard in chief if guard != ALWAYS))
        for block in blocks(self._unswept()):
            for guard in chief:
                yield from self.first_steps.near(block, guard)
        if self._ends():
            return
        yield from tries.combining.held(chief)
        for factor, before in FURTHER:
            for guard in chief:
                leading = tries.leading(before, guard, -tries.slack)
                still = [unit for unit in self._families if unit not in leading]
                yield from tries.sweep(factor, guard, [*leading, *still])
                yield from tries.adjusting.amid(guard)
                yield from self.crossing.inward(guard)
                yield from tries.adjusting.exactly(guard)
                yield from tries.combining.leaders(guard)
        if not gains.anything():
            yield from self._late_ones(self.aside, chief)
            yield from self.crossing.across(chief[0], plateau.STEPS)
        for factor in (*BETWEEN, FLIP):
            for guard in chief:
                yield from tries.sweep(factor, guard, gains.moving(tries.units))

    def _late_ones(self, late: Sequence[Unit], guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try operands that are in no data flow, such as the period of a timer."""
        tries = self.attempts
        new = [unit for unit in late if unit not in tries.units]
        tries.units = (*tries.units, *new)
        for guard in guards if new else ():
            yield from self.first_steps.near(new, guard)

    def _finely(self, guards: Sequence[Guard]) -> Iterator[Candidate]:
        """Try small steps on unrefined operands that change the reward, in case the good range is narrow.

        A proposed change that clearly lost with every value so far is harmful by itself and gets no such steps. A
        constant that lost with every value may still have a good value close to the old one, so it gets them. If no
        step gains, try the steps in between on named constants.
        """
        tries, gains = self.attempts, self.attempts.gains
        for factor in (*FINE, *BETWEEN_FINE):
            if factor in BETWEEN_FINE and gains.anything():
                return
            among = tries.units if factor in FINE else named(tries.units)
            for guard in guards:
                moved = [unit for unit in gains.moving(among) if gains.matters(unit)]
                if tries.proposed:
                    moved = [unit for unit in moved if not gains.always_lost((unit, guard))]
                yield from tries.sweep(
                    factor,
                    guard,
                    [unit for unit in moved if not tries.adjusting.refined[unit, guard]],
                )

    def effects(self) -> dict[str, list[OperandEffect]]:
        """For each site, return the gain of each operand's best value over the unmutated runs of the same seeds."""
        return best_effects(
            [(unit, gains) for (unit, _), gains in self.attempts.gains.items()], self.attempts.mutate
        )
