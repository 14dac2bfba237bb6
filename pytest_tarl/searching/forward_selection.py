"""Combined repairs by greedy forward selection: add units to the best one until the goal is reached.

A part of a combination is a unit with its factor. Units are chosen by the gain that each has alone, as in matching
pursuit. After each step, the factors of all parts are balanced: each one is adjusted to the others. Parts that are not
needed are dropped before the candidate is yielded.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.polishing import ALMOST, KNOWN, MUCH, SEEDS, SHARP_STEPS, Factors, polished
from pytest_tarl.searching.preferred_first import then
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import NEAR, Unit

MOST = 3  # maximum number of parts in a combined repair
PROMISING = 0.5  # a combination is balanced only if its gain is at least this share of the wanted gain
# number of units that are combined with the first unit; it is large because a useful unit may gain little alone
LEADERS = 5
STEPS = (1.5, 0.65)  # factors that are tried on one part of a combination to balance the combination
# factors by which a fixed parameter of a structural change is multiplied, once or several times
CLIMBS = (0.9, 1.1)
CLIMB = 4  # how often one fixed parameter may be multiplied by a factor of CLIMBS
AMPLE = 1.02  # a refused combination is adjusted only if its gain is at most this share of the wanted gain
STRONG = 5.0  # factor for units that have no effect alone


@dataclass(frozen=True, slots=True)
class Joint:
    """A combination: several units with their factors, under one guard."""

    parts: tuple[tuple[Unit, float], ...]
    guard: Guard

    def candidate(self, mutate: Mutate) -> Candidate:
        """Return the mutations of all parts."""
        return Candidate(
            tuple(m for unit, factor in self.parts for m in unit.mutations(mutate, factor)), self.guard
        )

    def with_part(self, unit: Unit, factor: float) -> Joint:
        """Return a copy with this part added or replaced."""
        kept = tuple(part for part in self.parts if part[0].operands != unit.operands)
        return Joint((*kept, (unit, factor)), self.guard)

    def without(self, unit: Unit) -> Joint:
        """Return a copy without this part."""
        return Joint(tuple(part for part in self.parts if part[0] != unit), self.guard)


Preferred = Callable[[Candidate, Unit, float], Iterator[Candidate]]


@dataclass(frozen=True)
class Settled:
    """Two sets of candidates: those that were tried on further seeds, and those that were confirmed and yielded."""

    tried: set[Candidate] = field(default_factory=set)
    held: set[Candidate] = field(default_factory=set)
    polished: set[frozenset[Unit]] = field(default_factory=set)  # combinations whose factors were adjusted

    def holds(self, candidate: Candidate, trials: Trials, goal: Goal, first: int) -> bool:
        """Return whether further seeds confirm a candidate. Return False if the candidate was tried before."""
        if candidate in self.tried:
            return False
        self.tried.add(candidate)
        if not confirmed(candidate, trials, goal, first):
            return False
        self.held.add(candidate)
        return True


class ForwardSelection:
    """Combine changes of several units.

    `gains` maps each unit to the gain of each factor when only this unit is changed. Gains below `slack` do not matter.

    If a confirmed combination needs only one of its parts, `preferred` yields the changes that a maintainer would
    prefer to this part. They come first.
    """

    def __init__(
        self,
        units: Sequence[Unit],
        mutate: Mutate,
        trials: Trials,
        goal: Goal,
        gains: Mapping[Unit, Mapping[float, float]],
        slack: float,
        settled: Settled | None = None,
        preferred: Preferred = lambda *_: iter(()),
    ) -> None:
        self.preferred = preferred
        self.units = units
        self.mutate = mutate
        self.trials = trials
        self.goal = goal
        self.gains = gains
        self.slack = slack
        self.settled = settled or Settled()

    def candidates(self, base: Joint) -> Iterator[Candidate]:
        """Yield confirmed combinations, starting with `base`.

        Each unit is first tried with its better factor. If no unit has an effect, the other factors are not tried: with
        `base`, the program then does nothing that other units could improve.
        """
        gain = yield from self.gain(base)
        if base.candidate(self.mutate) in self.settled.held:
            # the first combination reaches the goal on this seed, so no further part can show a gain
            return
        while gain is not None and len(base.parts) < MOST:
            better, most = base, gain
            for turn in range(len(NEAR)):
                widened = list(self._with_another(base, turn))
                self.expect(widened)
                for wider in widened:
                    gained = yield from self.gain(wider)
                    if gained is not None and gained > most:
                        better, most = wider, gained
                if all(self._inert(wider, base) for wider in widened):
                    break
            if most <= gain + self.slack:
                return
            base, gain = yield from self._balanced(better, most)

    def _inert(self, wider: Joint, base: Joint) -> bool:
        """Return whether `wider` has the same outcome as `base` on the first seed."""
        ran = [self.trials.ran(one.candidate(self.mutate), self.goal.pairs[:1]) for one in (wider, base)]
        return bool(ran[0]) and [(one.total, one.steps) for one in ran[0]] == [
            (one.total, one.steps) for one in ran[1]
        ]

    def unions(
        self, parts: Sequence[tuple[Unit, float]], guard: Guard, hidden: Sequence[Unit] = ()
    ) -> Iterator[Candidate]:
        """Combine the first part with each other part, add a third to the best pair, and balance it.

        `hidden` are the units that never changed a reward alone.
        """
        first = Joint(tuple(parts[:1]), guard)
        if first.candidate(self.mutate) in self.settled.held:
            return
        base: Joint | None = first
        best: tuple[Joint, float] | None = None
        needed = self.goal.wanted
        while base is not None and len(base.parts) < MOST:
            joints = [base.with_part(*part) for part in parts[: LEADERS + 1] if part not in base.parts]
            base = None
            self.expect(joints)
            for joint in joints:
                gained = yield from self.gain(joint)
                if gained is not None and (best is None or gained > best[1]):
                    best, base = (joint, gained), joint
            if best is not None and self._suffices(best[1]):
                # these two parts suffice on this seed but not on others: adjust their values instead of adding parts
                break
        if best is not None and best[1] > PROMISING * needed:
            joint, gain = yield from self._balanced(*best)
            if len(joint.parts) > 1 and not self._suffices(gain):
                pair = Joint(best[0].parts[: MOST - 1], guard)
                yield from self._with_what_was_hidden(pair, hidden)

    def _with_what_was_hidden(self, pair: Joint, hidden: Sequence[Unit]) -> Iterator[Candidate]:
        """Add units that had no effect alone to a good pair: they may matter now, because missions last longer."""
        best, most = pair, (yield from self.gain(pair)) or 0.0
        before = most
        for unit in hidden if most > PROMISING * self.goal.wanted else ():
            wider = pair.with_part(unit, STRONG)
            gained = yield from self.gain(wider)
            if gained is not None and gained > most:
                best, most = wider, gained
            if self._suffices(most):
                return
        if most > before + self.slack:
            yield from self._balanced(best, most)

    def _suffices(self, gain: float) -> bool:
        return gain >= self.goal.enough - self.goal.pairs[0].total

    def expect(self, joints: Sequence[Joint]) -> None:
        """Announce the combinations that run next unless a result changes the order."""
        seed = self.goal.pairs[0].seed
        self.trials.expect((joint.candidate(self.mutate), seed) for joint in joints)

    def candidates_of(self, joint: Joint) -> Iterator[Candidate]:
        """Run a combination. If it is confirmed, yield it without unneeded parts. If it gains much, balance it."""
        gain = yield from self.gain(joint)
        if gain is not None and PROMISING * self.goal.wanted < gain and not self._suffices(gain):
            yield from self._balanced(joint, gain)

    def gain(self, joint: Joint) -> Generator[Candidate, None, float | None]:
        """Run a combination once and yield it if confirmed; return its gain, or None if it cannot run."""
        candidate = joint.candidate(self.mutate)
        try:
            near = self._reached(candidate)
        except RepairError:
            return None
        if near and candidate not in self.settled.tried:
            yield from self._settling(joint, candidate)
        return self.trials.gain(candidate, self.goal)

    def climbed(self, base: Joint, unit: Unit) -> Iterator[Candidate]:
        """Add a unit and move it in small steps up or down while the gain increases."""
        most = yield from self.gain(base)
        for step in CLIMBS if most is not None else ():
            before, best = most, most
            for number in range(1, CLIMB + 1):
                gained = yield from self.gain(base.with_part(unit, round(step**number, 3)))
                if gained is None or best is None or gained <= best:
                    break
                best = gained
            if best != before:
                return

    def fewest(self, joint: Joint) -> Iterator[Candidate]:
        """Drop unneeded parts. Yield the result if it is confirmed and has at most `MOST` parts."""
        try:
            fewer = self._least(joint) if self._reached(joint.candidate(self.mutate)) else joint
            candidate = fewer.candidate(self.mutate)
            if len(fewer.parts) <= MOST and self.settled.holds(candidate, self.trials, self.goal, 0):
                yield candidate
        except RepairError:
            return

    def _settling(self, joint: Joint, candidate: Candidate) -> Iterator[Candidate]:
        """Drop unneeded parts and yield the result if it is confirmed and new.

        Adjust the factors in two cases: the result is not confirmed, or the caller refuses it because it barely earns
        enough.
        """
        least = self._least(joint)
        fewer = least.candidate(self.mutate)
        if fewer in self.settled.held:
            self.settled.tried.add(candidate)
            return
        for one in dict.fromkeys((fewer, candidate)):
            if one != fewer and self.trials.same_as(one, fewer):
                break  # the dropped parts have no effect, so the result would be the same
            if self.settled.holds(one, self.trials, self.goal, 0):
                alone = one == fewer and len(least.parts) == 1
                yield from then(one, self.preferred(one, *least.parts[0]) if alone else iter(()))
                if self.trials.harms(one) or self.trials.gain(one, self.goal) > AMPLE * self.goal.wanted:
                    # the combination was refused although it earns enough, so refining it does not help
                    return
                break
        yield from self._polished(least)

    def _polished(self, joint: Joint) -> Iterator[Candidate]:
        """Adjust the factors of a combination that passed its missions but earned slightly too little."""
        units = frozenset(unit for unit, _ in joint.parts)
        candidate, pairs = joint.candidate(self.mutate), self.goal.pairs
        ran = self.trials.ran(candidate, pairs)
        gained = self.trials.gain(candidate, self.goal) >= ALMOST * self.goal.wanted
        enough = len(ran) >= KNOWN and not any(map(self.goal.lost, ran))
        if units in self.settled.polished or len(units) < 2 or not (gained and enough):
            return
        self.settled.polished.add(units)

        def moved(factors: Factors) -> Joint:
            return Joint(
                tuple((unit, by) for (unit, _), by in zip(joint.parts, factors, strict=True)), joint.guard
            )

        def earned(factors: Factors, seed: int) -> float | None:
            try:
                outcome = self.trials(moved(factors).candidate(self.mutate), seed)
            except RepairError:
                return None
            return None if self.goal.lost(outcome) else outcome.total

        begin = tuple(factor for _, factor in joint.parts)
        seeds = [pair.seed for pair in pairs]
        better = moved(polished(begin, earned, seeds, self.goal.wanted))
        if better == joint:
            return
        for one in dict.fromkeys((self._least(better), better)):
            if self.settled.holds(one.candidate(self.mutate), self.trials, self.goal, 0):
                yield one.candidate(self.mutate)
                return

    def sharpened(self, unit: Unit, factor: float, guard: Guard) -> Iterator[Candidate]:
        """For a single unit that gains much, adjust the factor and yield the candidate if it is confirmed."""
        better = self.sharper(unit, factor, guard)
        candidate = Joint(((unit, better),), guard).candidate(self.mutate)
        if better != factor and self.settled.holds(candidate, self.trials, self.goal, 0):
            yield candidate

    def sharper(self, unit: Unit, factor: float, guard: Guard, steps: Sequence[float] = SHARP_STEPS) -> float:
        """Adjust the factor of a good single unit on the seeds on which it earns least; return the factor.

        Near a narrow range of good values, some missions fail. Here, unlike in a combination, failed missions therefore
        count with their reward.
        """
        base = Joint(((unit, factor),), guard)
        begin, pairs = base.candidate(self.mutate), self.goal.pairs
        ran = self.trials.totals_of(begin, pairs)
        if len(ran) < KNOWN or self.trials.gain(begin, self.goal) < MUCH * self.goal.wanted:
            return factor

        def earned(factors: Factors, seed: int) -> float | None:
            try:
                return self.trials(base.with_part(unit, factors[0]).candidate(self.mutate), seed).total
            except RepairError:
                return None

        hardest = sorted(ran, key=ran.__getitem__)
        enough = self.goal.enough_on(hardest[:SEEDS])
        (better,) = polished((factor,), earned, hardest, self.goal.wanted, steps, enough)
        return better

    def _with_another(self, base: Joint, turn: int) -> Iterator[Joint]:
        """Yield combinations with one more part. Turn 0 uses its better factor of `NEAR`, turn 1 the other one."""
        taken = {unit for unit, _ in base.parts}
        for unit in self.units:
            ranked = sorted(NEAR, key=lambda factor: self._progress(unit, factor, base.guard), reverse=True)
            if unit not in taken and unit.mutations(self.mutate, ranked[turn]):
                yield base.with_part(unit, ranked[turn])

    def _progress(self, unit: Unit, factor: float, guard: Guard) -> tuple[float, float, float]:
        """Return a key for comparing the factors of a unit; the factor with the larger key is better.

        If failed missions earn about the same, the longer mission is better, although its additional steps may cost
        reward.
        """
        gain = self.gains.get(unit, {}).get(factor, 0.0)
        if not self.goal.passing or abs(gain) > self.slack:
            return gain, 0.0, 0.0
        candidate = Joint(((unit, factor),), guard).candidate(self.mutate)
        known = [(self.trials.steps(candidate, [pair]), pair.steps) for pair in self.goal.pairs]
        ratios = [after[0] / before for after, before in known if after and before]
        return 0.0, fmean(ratios) if ratios else 1.0, gain

    def _balanced(self, base: Joint, gain: float) -> Generator[Candidate, None, tuple[Joint, float]]:
        """Move the factors one after the other while the gain increases; return the new combination and its gain."""
        for unit, factor in base.parts:
            for step in STEPS:
                moved = base.with_part(unit, round(factor * step, 3))
                gained = yield from self.gain(moved)
                if gained is not None and gained > gain:
                    base, gain = moved, gained
                    break
        return base, gain

    def _least(self, joint: Joint) -> Joint:
        """Drop the parts without which the combination still reaches the goal on the first seed."""
        for unit, _ in joint.parts:
            fewer = joint.without(unit)
            if fewer.parts and self._reached(fewer.candidate(self.mutate)):
                joint = fewer
        return joint

    def _reached(self, candidate: Candidate) -> bool:
        seed = self.goal.pairs[0].seed
        return self.trials.reaches(candidate, seed, self.goal)
