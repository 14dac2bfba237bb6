"""The full ranking of sites (statements with constants) by possible gain, and how certain the order is.

Every operand is run once with every factor. Then the best factors of each site are refined, and the sites race: they
run on common seeds, and their gains are compared.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.searching.halving import SLACK, arm_effects
from pytest_tarl.searching.race import LEAST, Arm, Race, ahead_by, behind, paired
from pytest_tarl.searching.search import FACTORS, BudgetSpentError, Goal, Mutate, Trials
from pytest_tarl.searching.units import NEAR, units
from tarl_lint.model import Operand, SiteId

FLIP = -1.0
OF_A_SITE = 2  # number of arms per site in the first race
SEEDS = 8  # number of common seeds of the final race


@dataclass(frozen=True, slots=True)
class Certainty:
    """How certain it is that the first site is ahead of all others.

    `by` is an approximate confidence interval for how much more the first site gains than the second one. It is
    measured on `seeds` common seeds; if these are too few, it is None. `level` is the number of other sites that cannot
    be distinguished from the first. `ahead` is the number of sites that gain significantly more. `gaining` is the
    number of sites that gain at all.
    """

    gaining: int
    level: int
    ahead: int
    by: tuple[float, float] | None
    seeds: int


class Ranking:
    """Rank all sites under one guard."""

    def __init__(
        self, operands: Sequence[Operand], mutate: Mutate, guard: Guard, trials: Trials, goal: Goal
    ) -> None:
        self.units = units(operands)
        self.guard = guard
        self.goal = goal
        self.slack = SLACK * goal.wanted
        self.race = Race(mutate, trials, goal)
        self.whole = False

    def run(self) -> None:
        """Run the ranking; if the budget ends first, keep the result so far."""
        try:
            self._sweep()
            self._race()
            self.whole = True
        except BudgetSpentError:
            pass

    def effects(self) -> dict[str, list[OperandEffect]]:
        """For each site, return the best gain of each operand."""
        return arm_effects(self.race)

    def certainty(self, first: str) -> Certainty | None:
        """Return the certainty that a site leads, or None if it has not run."""
        arms = {str(site): arm for site, arm in self._best().items()}
        if first not in arms:
            return None
        gains = self.race.gains
        lead, others = (
            gains[arms[first]],
            self.race.ranked(arm for site, arm in arms.items() if site != first),
        )
        differences = paired(lead, gains[others[0]]) if others else []
        ahead = [arm for arm in others if behind(lead, gains[arm])]
        level = [
            arm
            for arm in others
            if arm not in ahead and self.race.gain(arm) > self.slack and not behind(gains[arm], lead)
        ]
        return Certainty(
            sum(self.race.gain(arm) > self.slack for arm in arms.values()),
            len(level),
            len(ahead),
            ahead_by(differences) if len(differences) >= LEAST else None,
            len(differences),
        )

    def _sweep(self) -> None:
        """Run all operands on the first seed; skip far factors if near ones change nothing."""
        for at, factor in enumerate((*FACTORS, FLIP)):
            moving = self.units if at < len(NEAR) else [unit for unit in self.units if self._moves(unit)]
            self.race.run([Arm(unit, factor, self.guard) for unit in moving], 1)
        best = self._best().values()
        self.race.run(
            [one for arm in best if self.race.gain(arm) > self.slack for one in self.race.around(arm)], 1
        )

    def _moves(self, unit: object) -> bool:
        return any(
            gain != 0.0 for arm, seen in self.race.gains.items() if arm.unit == unit for gain in seen.values()
        )

    def _race(self) -> None:
        """Race each site's best arms on a few seeds, then the gaining ones on all."""
        for seeds in (LEAST, SEEDS):
            field = [
                arm
                for site in self._best()
                for arm in self.race.ranked(self._of(site))[: OF_A_SITE if seeds == LEAST else 1]
                if self.race.gain(arm) > self.slack
            ]
            self.race.run(field, seeds)

    def _best(self) -> Mapping[SiteId, Arm]:
        """Return the best arm of every site, among those that ran on most seeds."""
        best: dict[SiteId, Arm] = {}
        for arm in self.race.gains:
            site = arm.unit.operands[0].site
            if site not in best or self._standing(arm) > self._standing(best[site]):
                best[site] = arm
        return best

    def _standing(self, arm: Arm) -> tuple[int, float]:
        gains = self.race.gains[arm]
        return len(gains), fmean(gains.values())

    def _of(self, site: SiteId) -> list[Arm]:
        return [arm for arm in self.race.gains if arm.unit.operands[0].site == site]
