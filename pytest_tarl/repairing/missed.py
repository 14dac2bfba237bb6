"""Missions that refused candidates lost; later candidates must pass them before their test."""

from __future__ import annotations

from dataclasses import dataclass, field

from pytest_tarl.searching.accept import Acceptance, Reference
from pytest_tarl.searching.search import Candidate, Goal, Trials

LATEST = 3


@dataclass
class Missed:
    """Seeds on which tested candidates lost, each with the total that counts as near its designed mission."""

    seeds: list[tuple[int, float]] = field(default_factory=list)

    def learn(self, found: Acceptance, goal: Goal, reference: Reference) -> None:
        """Store the missions that a refused candidate lost."""
        slack = reference.mean - goal.near
        for seed, outcome, designed in zip(found.seeds, found.drifted, found.designed, strict=False):
            near = min(designed, reference.mean) - slack
            if outcome.total < near or goal.lost(outcome):
                self.seeds.append((seed, near))

    def again(self, candidate: Candidate, trials: Trials, goal: Goal) -> bool:
        """Tell whether a candidate loses most of the latest stored missions. Raises BudgetSpentError."""
        lost, asked = 0, self.seeds[-LATEST:]
        for seed, near in asked:
            outcome = trials(candidate, seed)
            lost += outcome.total < near or goal.lost(outcome)
            if 2 * lost > len(asked):
                return True
        return False
