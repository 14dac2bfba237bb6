"""Races: candidates are run on the same seeds, so that what they gain can be compared pair by pair."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from statistics import fmean

from pytest_tarl.errors import RepairError
from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.model import Guard
from pytest_tarl.searching.search import Candidate, Mutate, Pair, Trials
from pytest_tarl.searching.units import Unit

CONFIDENCE = 0.95  # of an interval, which is approximate: it says what to run next, not what holds
LEAST = 3  # common seeds before anything is said to be behind
FINEST = 1.1  # ratio of two factors between which there is nothing to find

Gains = Mapping[int, float]  # by seed, over the unmutated run of that seed


@dataclass(frozen=True, slots=True)
class Arm:
    """A unit with a factor, under a guard."""

    unit: Unit
    factor: float
    guard: Guard

    def candidate(self, mutate: Mutate) -> Candidate | None:
        """Return what it is in the source; None where the factor changes nothing."""
        mutations = self.unit.mutations(mutate, self.factor)
        return Candidate(mutations, self.guard) if mutations else None


class Race:
    """Runs arms on the same seeds and keeps what each of them gained."""

    def __init__(self, mutate: Mutate, trials: Trials, pairs: Sequence[Pair]) -> None:
        self.mutate = mutate
        self.trials = trials
        self.pairs = pairs
        self.gains: dict[Arm, dict[int, float]] = {}

    def run(self, arms: Sequence[Arm], seeds: int) -> None:
        """Run all arms on the first so many seeds, where they were not run yet. Raises BudgetSpentError."""
        pairs = self.pairs[:seeds]
        wanted = [(arm, one) for arm in arms if (one := arm.candidate(self.mutate)) is not None]
        for pair in pairs:
            for at, (arm, candidate) in enumerate(wanted):
                if pair.seed in self.gains.get(arm, {}):
                    continue
                self.trials.expect((one, pair.seed) for _, one in wanted[at:])
                try:
                    total = self.trials(candidate, pair.seed).total
                except RepairError:
                    continue
                self.gains.setdefault(arm, {})[pair.seed] = total - pair.total

    def gain(self, arm: Arm) -> float:
        """Return what an arm gained on average; one that was never run gained nothing."""
        return fmean(self.gains[arm].values()) if arm in self.gains else 0.0

    def ranked(self, arms: Iterable[Arm]) -> list[Arm]:
        """Return the arms that were run, the most gaining first."""
        return sorted(
            (arm for arm in dict.fromkeys(arms) if arm in self.gains), key=lambda arm: -self.gain(arm)
        )

    def abreast(self, arms: Iterable[Arm]) -> list[Arm]:
        """Return the arms, ranked, without those that are surely behind the first one."""
        ranked = self.ranked(arms)
        return [arm for arm in ranked if not behind(self.gains[arm], self.gains[ranked[0]])]

    def around(self, arm: Arm) -> list[Arm]:
        """Return the arms between this one and its neighbours of the same unit, on a log scale."""
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
    """Tell whether one surely gains less than the leader, on the seeds of both."""
    differences = paired(leader, gains)
    return len(differences) >= LEAST and ahead_by(differences)[0] > 0.0


def ahead_by(differences: Sequence[float]) -> tuple[float, float]:
    """Return the approximate interval, at `CONFIDENCE`, of what one gains more than another on average."""
    found = mean_of(differences, (1.0 + CONFIDENCE) / 2)
    return found.low, found.high


def paired(one: Gains, other: Gains) -> list[float]:
    """Return by how much one gained more than the other, on each seed of both."""
    return [one[seed] - other[seed] for seed in one if seed in other]
