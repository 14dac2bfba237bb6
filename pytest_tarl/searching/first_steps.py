"""The first steps of a sweep under a guard, large enough to show whether a constant matters."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence

from pytest_tarl.model import Guard
from pytest_tarl.patching.clamps import BOUNDING
from pytest_tarl.searching import plateau
from pytest_tarl.searching.attempts import FLIP, Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.crossing import Crossing
from pytest_tarl.searching.failing_otherwise import in_between
from pytest_tarl.searching.forward_selection import Joint
from pytest_tarl.searching.further_on import further_on
from pytest_tarl.searching.laws import laws
from pytest_tarl.searching.limits_in_turn import LimitsInTurn
from pytest_tarl.searching.plainness import Oddness, kind, named
from pytest_tarl.searching.refining import FURTHER
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.twins import assigned_alone
from pytest_tarl.searching.units import NEAR, Unit
from pytest_tarl.searching.unmasking import lasting, longer
from tarl_lint.model import Operand

# number of best units that are tried with larger steps before the next guard is tried
LEADING = 3
# minimum gain of units that get larger steps (`LEADING`) or an even smaller step, as a share of the wanted gain
HINT = 0.005
BETWEEN = (1.5, 0.65)
FINER = (1.22, 0.82)
# steps for constants that clearly lost with all earlier steps: their good values are close to the old value
SENSITIVE = ((1.1, 0.91), (1.05, 0.95), (1.025, 0.975))
# maximum number of unnamed constants that get `SENSITIVE` steps, and of named constants that get `FINER` steps early
FEW = 3
# if a change gains at least this share of the wanted gain, other constants get no `FINER` steps
HALF = 0.5
LONGEST = 2  # limits are relaxed together with at most this number of changes that made missions last longer


_DECIDING = re.compile(rf"[<>]|[!=]=|\b(?:{'|'.join(('if', 'while', 'int', 'round', *sorted(BOUNDING)))})\b")


def deciding(text: str) -> bool:
    """Return whether a statement may compare, limit, round or store a value.

    A constant in such a statement may have an effect in one direction only.
    """
    return _DECIDING.search(text) is not None or bool(assigned_alone(text))


class FirstSteps:
    """Try the first steps of one search.

    `operands` are the constants of the search. `responding` contains ids of statements whose constants raised the
    reward. Changes that recorded missions suggest are tried once, if the first steps on named constants gained less
    than `HALF`.
    """

    def __init__(
        self,
        attempts: Attempts,
        crossing: Crossing,
        operands: Sequence[Operand],
        responding: Collection[str] = (),
    ) -> None:
        self.attempts = attempts
        self.crossing = crossing
        self.operands = operands
        self.responding = responding
        # phases of the search that run once
        self._measured = self._limited = self._lawful = False

    def everywhere(self, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Increase, then decrease the named constants without a condition. Conditions are tried later.

        Most drifts last for whole missions. The acceptance test then finds out whether the repair needs a condition.
        """
        tries = self.attempts
        for factor in NEAR:
            moving = tries.gains.moving(named(among))
            yield from tries.sweep(factor, ALWAYS, moving) if moving else ()
            if tries.gains.anything(HALF * tries.goal.wanted):
                return
            yield from self._as_measured(ALWAYS)
        yield from self._laws(ALWAYS)
        yield from self._limits(ALWAYS)

    def near(self, block: Sequence[Unit], guard: Guard) -> Iterator[Candidate]:
        """Increase and decrease each unit. If both steps lose, try smaller ones. Finally, combine the best units.

        Until a gain exceeds the noise level (`slack`), the `LEADING` best units get larger steps at once.
        """
        tries, gains = self.attempts, self.attempts.gains
        moving = gains.moving(block)
        yield from self._carried_over(guard)
        if tries.proposed:
            yield from tries.sweep(1.0, guard, moving)
            yield from self._strengthened(guard, moving)
            yield from tries.sweep(FLIP, guard, moving)
        else:
            yield from self._named_first(guard, named(moving))
        if gains.idle_guard(guard) and ALWAYS in tries.guards:
            return  # nothing has an effect under this condition; changes may have effects without it
        for factor in NEAR:
            yield from tries.sweep(
                factor, guard, [one for one in moving if not self._inert(one, guard, factor)]
            )
            if not tries.proposed and not gains.anything(HALF * tries.goal.wanted):
                yield from self._as_measured(self._unconditional(guard))
        yield from self._between_failures(guard, moving)
        yield from self.crossing.across(guard, plateau.STEPS[:2])
        yield from self._narrow(guard, moving)
        yield from tries.farther() if gains.anything() else ()
        for factor, before in () if gains.anything() else FURTHER:
            leading = tries.leading(before, guard, tries.goal.wanted * HINT)
            yield from tries.sweep(factor, guard, leading[:LEADING])
        yield from self._without_condition(guard)
        yield from self.crossing.inward(guard)
        yield from tries.adjusting.exactly(guard)
        yield from tries.combining.leaders(guard)
        yield from tries.combining.unmasked(guard)
        yield from self._uses_apart(guard, block)

    def _between_failures(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """If no change under the guard gained enough, try values between two values that fail for different reasons."""
        tries = self.attempts
        best = max((max(each.values()) for each in tries.gains.under(guard).values()), default=0.0)
        if not tries.proposed and best < HALF * tries.goal.wanted:
            tried = yield from in_between(tries, guard, among)
            if tried:
                yield from tries.adjusting.refine(tries.pair)

    def _inert(self, unit: Unit, guard: Guard, factor: float) -> bool:
        """Return whether a literal needs no second factor: the first had no effect, and `deciding` is false."""
        tried = self.attempts.gains.of(unit, guard)
        literal = unit.operands[0].literal and not self.attempts.proposed
        dull = factor == NEAR[1] and NEAR[0] in tried and not self.attempts.gains.moves(unit)
        return literal and dull and not deciding(unit.operands[0].site.text)

    def _named_first(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Increase the named constants. If none gains, try moderate steps on them before other constants are tried."""
        tries = self.attempts
        yield from tries.each(NEAR[0], guard, among, tries.pair)
        idle = tries.gains.idle_guard(guard) and ALWAYS in tries.guards
        if among and not tries.gains.anything(HALF * tries.goal.wanted):
            yield from self._as_measured(self._unconditional(guard))
        if among and not idle and not tries.gains.anything():
            tries.turn += 1
            yield from tries.sweep(NEAR[1], guard, among)
            yield from self._at_once(guard, among)
            yield from self._laws(self._unconditional(guard))
            yield from self.crossing.across(guard, plateau.STEPS[:2])
            yield from self._closely(guard, among)
        if among and not idle and not tries.gains.anything(HALF * tries.goal.wanted):
            yield from self._limits(self._unconditional(guard))

    def _at_once(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try smaller steps on the named constants that lose in both directions: their good values are near."""
        tries, pair = self.attempts, self.attempts.pair
        lost = tries.gains.lost_both_ways(guard, among, NEAR)
        for factor in BETWEEN if lost else ():
            yield from tries.each(factor, guard, lost, pair)
            yield from tries.adjusting.refine(pair)

    def _closely(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """If nothing gained clearly, try an even smaller step on named constants whose smallest step was the best.

        There are few such constants, so this costs less than the first steps on all literals.
        """
        tries = self.attempts
        for factor, before in zip(FINER, BETWEEN, strict=True):
            peaked = [unit for unit in among if self._best_is(before, unit, guard)]
            if peaked and len(peaked) <= FEW and not tries.gains.anything():
                yield from tries.sweep(factor, guard, peaked)

    def _best_is(self, factor: float, unit: Unit, guard: Guard) -> bool:
        """Return whether a factor of a unit gains a little, and more than its other factors."""
        gains = self.attempts.gains.of(unit, guard)
        most = max(gains.values(), default=0.0)
        return most > HINT * self.attempts.goal.wanted and gains.get(factor) == most

    def _laws(self, guard: Guard) -> Iterator[Candidate]:
        """If nothing gained, let named constants that lost in both directions follow a varying quantity (once only)."""
        tries, gains = self.attempts, self.attempts.gains
        lost = gains.clearly_lost(guard, named(tries.units), NEAR)
        if not self._lawful and lost and not gains.anything():
            self._lawful = True
            yield from laws(lost, tries.suggestions.proportional, tries.joining({}))

    def _limits(self, guard: Guard) -> Iterator[Candidate]:
        """Relax the limits that missions reach, alone and together with the changes that made missions longest.

        This is done once. Corrections of wrong readings are tried first.
        """
        if self._limited:
            return
        self._limited, tries = True, self.attempts
        yield from tries.interlude(tries.gains.best())
        joining, whole = tries.joining({}), self._whole
        parts = [
            Joint(((unit, factor),), guard)
            for unit, by_factor in tries.gains.under(guard).items()
            for factor in by_factor
            if factor > 0.0 and unit in whole.values()
        ]
        longest = sorted(parts, key=lambda one: -lasting(one, joining))[:LONGEST]
        bases = [one for one in longest if longer(one, joining)]
        yield from LimitsInTurn(joining, whole, tries.suggestions.reached, guard).candidates(bases)
        if not tries.gains.anything():
            rest = named(dict.fromkeys(whole.values()))
            yield from further_on(bases, rest, tries.suggestions.entered, joining)

    def _unconditional(self, guard: Guard) -> Guard:
        """Return `ALWAYS` if the search may change constants without a condition, else the guard."""
        return ALWAYS if ALWAYS in self.attempts.guards else guard

    @property
    def _whole(self) -> dict[Operand, Unit]:
        """Map each constant to the unit that contains all its uses."""
        units = reversed(self.attempts.units)
        return {operand: unit for unit in units if unit.chart is None for operand in unit.operands}

    def _as_measured(self, guard: Guard) -> Iterator[Candidate]:
        """Try the changes that recorded missions suggest, once, then refine the best constant.

        The suggestions come from whole missions, so the changes have no condition if possible.
        """
        if self._measured:
            return
        self._measured, tries = True, self.attempts
        whole, tried = self._whole, False
        for hint in tries.suggestions.measured(self.operands):
            parts = tuple({whole[operand]: factor for operand, factor in hint if operand in whole}.items())
            tried = tried or bool(parts)
            if len(parts) == 1:
                yield from tries.attempt(parts[0][0], guard, parts[0][1], tries.pair)
            elif parts:
                yield from tries.joining({}).candidates_of(Joint(parts, guard))
        if tried:
            yield from tries.adjusting.refine(tries.pair)

    def _uses_apart(self, guard: Guard, block: Sequence[Unit]) -> Iterator[Candidate]:
        """Change a constant at only one of its uses, because the effects at several uses may cancel each other out.

        Each use runs on the seed on which the constant was changed everywhere. This shows whether both changes have the
        same effect.
        """
        tries, gains = self.attempts, self.attempts.gains
        wholes = [whole for whole in gains.moving(block) if tries.uses.of(whole)]
        uses = [use for whole in wholes for use in tries.uses.of(whole)]
        tries.units = (*tries.units, *(use for use in uses if use not in tries.units))
        for factor in NEAR if uses else ():
            for whole in wholes:
                pair = tries.ran_on(whole, guard, factor)
                yield from tries.each(factor, guard, gains.moving(tries.uses.of(whole)), pair)
        if uses:
            yield from tries.adjusting.refine(tries.pair)

    def _strengthened(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """If a proposed change is too weak to have an effect, strengthen it.

        Use the largest factors only at statements that respond, that is, whose constants raised the reward.
        """
        tries = self.attempts
        for factor in (*NEAR, *(factor for factor, _ in FURTHER)):
            idle = [unit for unit in among if tries.gains.idle(unit)]
            if factor not in NEAR:
                idle = [unit for unit in idle if str(unit.operands[0].site) in self.responding]
            yield from tries.sweep(factor, guard, idle) if idle else ()

    def _carried_over(self, guard: Guard) -> Iterator[Candidate]:
        """Try the units that were best under other guards, because the other guards may be too narrow."""
        tries = self.attempts
        pair = tries.pair
        for unit, factor in tries.gains.best_under([one for one in tries.guards if one != guard])[:LEADING]:
            yield from tries.attempt(unit, guard, factor, pair)

    def _without_condition(self, guard: Guard) -> Iterator[Candidate]:
        """Try the change that gains most without its condition, because the condition may be too narrow."""
        tries, gains = self.attempts, self.attempts.gains
        for unit, factor in gains.best_under([guard])[:1]:
            if guard.conjuncts and ALWAYS in tries.guards and gains.most((unit, guard)) > tries.slack:
                yield from tries.attempt(unit, ALWAYS, factor, tries.pair)

    def _narrow(self, guard: Guard, among: Sequence[Unit]) -> Iterator[Candidate]:
        """Try smaller steps on operands that lost when increased and when decreased: their best values must be near.

        If the smaller steps lose, too, and nothing else is promising, try the `FINER` and then the `SENSITIVE` steps.
        """
        tries, gains = self.attempts, self.attempts.gains
        lost = gains.lost_both_ways(guard, among, NEAR)
        for factor in BETWEEN if lost else ():
            yield from tries.sweep(factor, guard, lost)
        promising = tries.proposed or gains.anything(HALF * tries.goal.wanted)
        still = [] if promising else gains.lost_both_ways(guard, lost, BETWEEN)
        for factor in FINER if still else ():
            yield from tries.sweep(factor, guard, still)
        before, sensitive = FINER, self._few(guard, still)
        for steps in SENSITIVE if not tries.proposed else ():
            sensitive = gains.clearly_lost(guard, sensitive, before)
            if not sensitive or gains.anything(HALF * tries.goal.wanted):
                return
            for factor in steps:
                yield from tries.sweep(factor, guard, sensitive)
            before = steps

    def _few(self, guard: Guard, among: Sequence[Unit]) -> list[Unit]:
        """Return the named constants that lose with all steps. If there are none, return the others if they are few."""
        lost = self.attempts.gains.clearly_lost(guard, among, FINER)
        lost = [unit for unit in lost if unit.chart is None and kind(unit) < Oddness.OFFSET]
        return named(lost) or (lost if len(lost) <= FEW else [])
