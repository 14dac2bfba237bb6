"""Missions in which refused candidates lost reward. Later candidates run these missions before their own test."""

from __future__ import annotations

from dataclasses import dataclass, field

from pytest_tarl.learning.drift import PASS_RATE_LOSS
from pytest_tarl.searching.accept import Acceptance, Reference
from pytest_tarl.searching.search import Candidate, Goal, Trials
from tarl_lint.model import Operand

LATEST = 3
FEW = 0.25  # a candidate's value counts as nearly right if at most this share of its missions loses reward
SPREAD = 5  # number of missions from each earlier test that a later candidate runs


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
    """Seeds on which tested candidates lost reward, with the total reward that counts as close to designed.

    - `few`: these seeds, for candidates that lost reward in at most the share `FEW` of their missions.
    - `poor`: candidates that failed hardly any mission but earned too little.
    - `spread`: for each candidate in `poor`, missions of its test, from the smallest to the largest loss.
    - `costly`: candidates that fail hardly any drifted mission but may lose too much in the designed world.
    - `harmed`: maps the constants of a candidate to a recorded mission that the candidate made worse.
    - `designed`: what candidates earned in recorded missions.
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
            # where the designed mission fails, too, no change can do better
            hopeless = goal.passing and designed < goal.near
            if not hopeless and (outcome.total < near or goal.lost(outcome)):
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
        """Return whether a refused candidate's missions succeeded. A better value may then be all that is needed."""
        return candidate in self.costly or candidate in self.spread

    def equate(self, candidate: Candidate, other: Candidate) -> None:
        """Use the results of `candidate` in recorded missions for `other`, which has the same effect."""
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
        """Return whether a candidate loses no reward in missions where `refused` lost some. Raise BudgetSpentError."""
        return not any(_loses(candidate, trials, goal, seed, near) for seed, near in self.few[refused])


def _spread(found: Acceptance) -> list[Lost]:
    """Sort the missions by loss and return some at equal intervals, so that their mean loss is close to the test's."""
    rows = zip(found.seeds, found.drifted, found.designed, strict=False)
    ranked = sorted(
        (Lost(seed, outcome.total, total) for seed, outcome, total in rows), key=lambda one: one.loss
    )
    many = min(SPREAD, len(ranked))
    return [ranked[(2 * at + 1) * len(ranked) // (2 * many)] for at in range(many)]


def _loses(candidate: Candidate, trials: Trials, goal: Goal, seed: int, near: float) -> bool:
    outcome = trials(candidate, seed)
    return outcome.total < near or goal.lost(outcome)
