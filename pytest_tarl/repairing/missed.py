"""Missions in which refused candidates lost reward. Later candidates run on them first, before their own test."""

from __future__ import annotations

from dataclasses import dataclass, field

from pytest_tarl.learning.drift import PASS_RATE_LOSS
from pytest_tarl.searching.accept import Acceptance, Reference
from pytest_tarl.searching.search import Candidate, Goal, Trials
from tarl_lint.model import Operand

LATEST = 3
FEW = 0.25  # a candidate's value counts as nearly right if at most this share of its missions loses reward
SPREAD = 5  # number of missions of each test that are run


@dataclass(frozen=True, slots=True)
class Lost:
    """A mission of a refused candidate: its seed, the candidate's total reward, and the designed total reward."""

    seed: int
    total: float
    designed: float

    @property
    def loss(self) -> float:
        """Return the reward that the candidate lost."""
        return self.designed - self.total


@dataclass
class Missed:
    """Seeds on which tested candidates lost reward, each with the total that counts as close to the designed mission.

    `few` holds these seeds for candidates that lost reward in at most `FEW` of their missions. `poor` holds the
    candidates that failed hardly any mission but earned too little. For each of these, `spread` holds missions of its
    test, from the smallest to the largest loss. `costly` holds the candidates that may lose too much in the designed
    world, and hardly any mission under the drift. `harmed` holds, for the constants of a candidate, a recorded mission
    that it made worse, and `designed` what candidates earned in recorded missions.
    """

    seeds: list[tuple[int, float]] = field(default_factory=list)
    few: dict[Candidate, list[tuple[int, float]]] = field(default_factory=dict)
    poor: set[Candidate] = field(default_factory=set)
    spread: dict[Candidate, list[Lost]] = field(default_factory=dict)
    costly: set[Candidate] = field(default_factory=set)
    harmed: dict[frozenset[Operand], int] = field(default_factory=dict)
    designed: dict[tuple[Candidate, int], float] = field(default_factory=dict)

    def learn(self, candidate: Candidate, found: Acceptance, goal: Goal, reference: Reference) -> None:
        """Store the missions in which a refused candidate lost reward."""
        slack, lost = reference.mean - goal.near, []
        for seed, outcome, designed in zip(found.seeds, found.drifted, found.designed, strict=False):
            near = min(designed, reference.mean) - slack
            if outcome.total < near or goal.lost(outcome):
                lost.append((seed, near))
        self.seeds += lost
        if 0 < len(lost) <= FEW * len(found.drifted):
            self.few[candidate] = lost[-LATEST:]
        failed = sum(not outcome.passed for outcome in found.drifted)
        if found.costly:
            self.costly.add(candidate)
        elif goal.passing and failed <= PASS_RATE_LOSS * len(found.drifted):
            self.poor.add(candidate)
            self.spread[candidate] = _spread(found)

    def latest(self) -> list[int]:
        """Return the seeds of the missions stored last."""
        return [seed for seed, _ in self.seeds[-LATEST:]]

    def nearly_right(self, candidate: Candidate) -> bool:
        """Return whether a refused candidate's missions succeeded, so that its value may only have to be improved."""
        return candidate in self.costly or candidate in self.spread

    def equate(self, candidate: Candidate, other: Candidate) -> None:
        """Use the results of a candidate in recorded missions for another one that acts alike."""
        for (one, seed), total in list(self.designed.items()):
            if one == candidate:
                self.designed.setdefault((other, seed), total)

    def again(self, candidate: Candidate, trials: Trials, goal: Goal) -> bool:
        """Return whether a candidate loses reward in most of the missions stored last. Raise BudgetSpentError."""
        lost, asked = 0, self.seeds[-LATEST:]
        for seed, near in asked:
            lost += _loses(candidate, trials, goal, seed, near)
            if 2 * lost > len(asked):
                return True
        return False

    def mends(self, candidate: Candidate, refused: Candidate, trials: Trials, goal: Goal) -> bool:
        """Return whether a candidate loses no reward in the missions in which `refused` did. Raise BudgetSpentError."""
        return not any(_loses(candidate, trials, goal, seed, near) for seed, near in self.few[refused])


def _spread(found: Acceptance) -> list[Lost]:
    """Return missions at equally spaced ranks of the loss, so that their mean loss is close to that of the test."""
    rows = zip(found.seeds, found.drifted, found.designed, strict=False)
    ranked = sorted(
        (Lost(seed, outcome.total, total) for seed, outcome, total in rows), key=lambda one: one.loss
    )
    many = min(SPREAD, len(ranked))
    return [ranked[(2 * at + 1) * len(ranked) // (2 * many)] for at in range(many)]


def _loses(candidate: Candidate, trials: Trials, goal: Goal, seed: int, near: float) -> bool:
    outcome = trials(candidate, seed)
    return outcome.total < near or goal.lost(outcome)
