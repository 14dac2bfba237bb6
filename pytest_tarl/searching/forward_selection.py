"""Several culprits: add the best of all others to what gains most, and again, until it suffices.

A greedy choice by main effects, as in matching pursuit, with the parts balanced against each other after each step;
what turns out not to be needed is dropped before the candidate is handed on.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials, confirmed
from pytest_tarl.searching.units import NEAR, Unit

MOST = 3  # parts of a joint repair
PROMISING = 0.5  # a union that gains this share of the loss is worth balancing
LEADERS = 5  # those that are added to the first, of which one may have too little to show alone
STEPS = (1.5, 0.65)  # by which the parts are moved


@dataclass(frozen=True, slots=True)
class Joint:
    """Units with their factors, under one guard."""

    parts: tuple[tuple[Unit, float], ...]
    guard: Guard

    def candidate(self, mutate: Mutate) -> Candidate:
        """Return the mutations of all parts."""
        return Candidate(
            tuple(m for unit, factor in self.parts for m in unit.mutations(mutate, factor)), self.guard
        )

    def with_part(self, unit: Unit, factor: float) -> Joint:
        """Return it with a part added or replaced."""
        kept = tuple(part for part in self.parts if part[0] != unit)
        return Joint((*kept, (unit, factor)), self.guard)

    def without(self, unit: Unit) -> Joint:
        """Return it with a part left out."""
        return Joint(tuple(part for part in self.parts if part[0] != unit), self.guard)


@dataclass(frozen=True)
class Settled:
    """Candidates that were tried on further seeds, and those of them that held and were handed on."""

    tried: set[Candidate] = field(default_factory=set)
    held: set[Candidate] = field(default_factory=set)

    def holds(self, candidate: Candidate, trials: Trials, goal: Goal, first: int) -> bool:
        """Try a candidate on further seeds, once; False for one that was tried before."""
        if candidate in self.tried:
            return False
        self.tried.add(candidate)
        if not confirmed(candidate, trials, goal, first):
            return False
        self.held.add(candidate)
        return True


class ForwardSelection:
    """Joins units; `gains` are those of the single ones by factor, `slack` is the gain that makes a difference."""

    def __init__(
        self,
        units: Sequence[Unit],
        mutate: Mutate,
        trials: Trials,
        goal: Goal,
        gains: Mapping[Unit, Mapping[float, float]],
        slack: float,
        settled: Settled | None = None,
    ) -> None:
        self.units = units
        self.mutate = mutate
        self.trials = trials
        self.goal = goal
        self.gains = gains
        self.slack = slack
        self.settled = settled or Settled()

    def candidates(self, base: Joint) -> Iterator[Candidate]:
        """Yield joint candidates that hold on every seed they were tried on."""
        gain = yield from self.gain(base)
        if base.candidate(self.mutate) in self.settled.held:
            return  # nothing is missing on this seed that another part could add
        while gain is not None and len(base.parts) < MOST:
            better, most = base, gain
            widened = list(self._with_another(base))
            self.expect(widened)
            for wider in widened:
                gained = yield from self.gain(wider)
                if gained is not None and gained > most:
                    better, most = wider, gained
            if most <= gain + self.slack:
                return
            base, gain = yield from self._balanced(better, most)

    def unions(self, parts: Sequence[tuple[Unit, float]], guard: Guard) -> Iterator[Candidate]:
        """Join the leading part with the next ones, the best two with a third, and balance what gains most."""
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
            if best is not None and best[1] >= self.goal.enough - self.goal.pairs[0].total:
                break  # two suffice here, though not on fresh seeds: better values help, not more parts
        if best is not None and best[1] > PROMISING * needed:
            yield from self._balanced(*best)

    def expect(self, joints: Sequence[Joint]) -> None:
        """Tell which joint candidates are run next, unless something comes between."""
        seed = self.goal.pairs[0].seed
        self.trials.expect((joint.candidate(self.mutate), seed) for joint in joints)

    def gain(self, joint: Joint) -> Generator[Candidate, None, float | None]:
        """Run a joint candidate once and return its gain, None where it cannot run; hand it on when it holds."""
        candidate = joint.candidate(self.mutate)
        try:
            near = self._reached(candidate)
        except RepairError:
            return None
        if near and candidate not in self.settled.tried:
            yield from self._settling(joint, candidate)
        return self.trials.gain(candidate, self.goal.pairs)

    def _settling(self, joint: Joint, candidate: Candidate) -> Iterator[Candidate]:
        """Hand on what holds, without the parts that it does not need; nothing where the rest was handed on before."""
        fewer = self._least(joint).candidate(self.mutate)
        if fewer in self.settled.held:
            self.settled.tried.add(candidate)
            return
        for one in dict.fromkeys((fewer, candidate)):
            if self.settled.holds(one, self.trials, self.goal, 0):
                yield one
                return

    def _with_another(self, base: Joint) -> Iterator[Joint]:
        """Yield joints with one part more, first as each was best alone, then the other way."""
        taken = {unit for unit, _ in base.parts}
        for turn in range(len(NEAR)):
            for unit in self.units:
                gains = self.gains.get(unit, {})
                ranked = sorted(NEAR, key=lambda factor: -gains.get(factor, 0.0))
                if unit not in taken and unit.mutations(self.mutate, ranked[turn]):
                    yield base.with_part(unit, ranked[turn])

    def _balanced(self, base: Joint, gain: float) -> Generator[Candidate, None, tuple[Joint, float]]:
        """Move the parts one by one, as long as that gains."""
        for unit, factor in base.parts:
            for step in STEPS:
                moved = base.with_part(unit, round(factor * step, 3))
                gained = yield from self.gain(moved)
                if gained is not None and gained > gain:
                    base, gain = moved, gained
                    break
        return base, gain

    def _least(self, joint: Joint) -> Joint:
        """Leave out what is not needed on the first seed."""
        for unit, _ in joint.parts:
            fewer = joint.without(unit)
            if fewer.parts and self._reached(fewer.candidate(self.mutate)):
                joint = fewer
        return joint

    def _reached(self, candidate: Candidate) -> bool:
        seed = self.goal.pairs[0].seed
        return self.goal.reached(self.trials(candidate, seed), seed)
