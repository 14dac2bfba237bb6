"""Race candidates: run them on the same seeds and compare their gains seed by seed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.model import Guard
from pytest_tarl.searching.search import Candidate, Goal, Mutate, Trials
from pytest_tarl.searching.units import Unit

# confidence of the approximate interval that decides which arms run next; it does not decide what is accepted
CONFIDENCE = 0.95
# an arm can count as significantly worse than another one only if both ran on this number of common seeds
LEAST = 3
FINEST = 1.1  # no factor is tried between two factors whose ratio is below this

Gains = Mapping[int, float]  # seed → gain over the unmutated run of that seed


@dataclass(frozen=True, slots=True)
class Arm:
    """A change to race: a unit (operands mutated together), its factor, and its guard (condition)."""

    unit: Unit
    factor: float
    guard: Guard

    def candidate(self, mutate: Mutate) -> Candidate | None:
        """Return the arm as a candidate, or None if the factor changes nothing."""
        mutations = self.unit.mutations(mutate, self.factor)
        return Candidate(mutations, self.guard) if mutations else None


class Race:
    """Run arms on common seeds and store their gains."""

    def __init__(self, mutate: Mutate, trials: Trials, goal: Goal) -> None:
        self.mutate = mutate
        self.trials = trials
        self.goal = goal
        self.gains: dict[Arm, dict[int, float]] = {}

    def run(self, arms: Sequence[Arm], seeds: int) -> None:
        """Run all arms on the first `seeds` seeds; skip episodes that have already run. Raise BudgetSpentError."""
        pairs = self.goal.pairs[:seeds]
        wanted = [(arm, one) for arm in arms if (one := arm.candidate(self.mutate)) is not None]
        for pair in pairs:
            for at, (arm, candidate) in enumerate(wanted):
                if pair.seed in self.gains.get(arm, {}):
                    continue
                self.trials.expect((one, pair.seed) for _, one in wanted[at:])
                try:
                    outcome = self.trials(candidate, pair.seed)
                except RepairError:
                    continue
                self.gains.setdefault(arm, {})[pair.seed] = self.goal.gain(outcome, pair.total)

    def gain(self, arm: Arm) -> float:
        """Return the mean gain of an arm, or 0 if it has not run."""
        return fmean(self.gains[arm].values()) if arm in self.gains else 0.0

    def ranked(self, arms: Iterable[Arm]) -> list[Arm]:
        """Return the arms that have run, best gain first."""
        return sorted(
            (arm for arm in dict.fromkeys(arms) if arm in self.gains), key=lambda arm: -self.gain(arm)
        )

    def abreast(self, arms: Iterable[Arm]) -> list[Arm]:
        """Return the arms, best gain first, without the arms that gain significantly less than the best one."""
        ranked = self.ranked(arms)
        return [arm for arm in ranked if not behind(self.gains[arm], self.gains[ranked[0]])]

    def around(self, arm: Arm) -> list[Arm]:
        """Return new arms of the same unit, halfway (in log scale) to the neighbouring factors."""
        tried = sorted(
            one.factor
            for one in self.gains
            if one.unit == arm.unit and one.guard == arm.guard and one.factor > 0
        )
        if arm.factor not in tried:
            return []
        at = tried.index(arm.factor)
        beside = [*tried[max(at - 1, 0) : at], *tried[at + 1 : at + 2]]
        apart = [one for one in beside if max(one, arm.factor) > FINEST * min(one, arm.factor)]
        return [Arm(arm.unit, round(sqrt(one * arm.factor), 3), arm.guard) for one in apart]


def behind(gains: Gains, leader: Gains) -> bool:
    """Return whether an arm gains significantly less than the leader on their common seeds."""
    differences = paired(leader, gains)
    return len(differences) >= LEAST and ahead_by(differences)[0] > 0.0


def ahead_by(differences: Sequence[float]) -> tuple[float, float]:
    """Return an approximate confidence interval (`CONFIDENCE`) for the mean of `differences`."""
    found = mean_of(differences, (1.0 + CONFIDENCE) / 2)
    return found.low, found.high


def paired(one: Gains, other: Gains) -> list[float]:
    """Return the difference in gain on each common seed."""
    return [one[seed] - other[seed] for seed in one if seed in other]
