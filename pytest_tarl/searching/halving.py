"""Sequential halving: run all arms (an operand with a factor), and drop half in each round.

In each round, all arms run on the same seeds. The search also drops arms that gain nothing, and arms that are
significantly worse than the best one on common seeds. It refines the best arms. References: Karnin, Koren & Somekh
2013; for the race, Maron & Moore 1994. The first round runs every arm once, so the search needs at least (operands ×
factors) episodes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.race import Arm, Race
from pytest_tarl.searching.search import FACTORS, Candidate, Goal, Mutate, Trials, operand_effect
from pytest_tarl.searching.units import units
from tarl_lint.model import Operand

ROUNDS = (1, 2, 4, 8)  # number of seeds per arm after each round
REFINED = 3  # number of arms to refine between two rounds
SLACK = 0.1  # minimum gain that counts, as a share of the loss


class Halving:
    """Sequential halving with a race on common seeds and refinement, one guard after the other."""

    def __init__(
        self,
        operands: Sequence[Operand],
        mutate: Mutate,
        guards: Sequence[Guard],
        trials: Trials,
        goal: Goal,
    ) -> None:
        self.units = units(operands)
        self.guards = guards
        self.goal = goal
        self.slack = SLACK * goal.wanted
        self.race = Race(mutate, trials, goal)
        self._confirmed: set[Candidate] = set()

    def candidates(self) -> Iterator[Candidate]:
        """Yield confirmed candidates, round by round."""
        for guard in self.guards:
            arms = [Arm(unit, factor, guard) for factor in FACTORS for unit in self.units]
            for seeds in ROUNDS:
                self.race.run(arms, seeds)
                yield from self._holding(arms)
                arms = self._kept(arms)
            yield from self._together(guard)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """For each site, return the gain of each operand's best arm, relative to unmutated runs of the same seeds."""
        return arm_effects(self.race)

    def _holding(self, arms: Sequence[Arm]) -> Iterator[Candidate]:
        """Confirm the arms that nearly reached the goal on all seeds of the round, best first."""
        race = self.race
        for arm in race.ranked(arms):
            candidate = arm.candidate(race.mutate)
            if candidate is None or candidate in self._confirmed:
                continue
            run = [pair for pair in self.goal.pairs if pair.seed in race.gains[arm]]
            if all(self.goal.reached(race.trials(candidate, pair.seed), pair.seed) for pair in run):
                self._confirmed.add(candidate)
                if confirmed(candidate, race.trials, self.goal, 0):
                    yield candidate

    def _kept(self, arms: Sequence[Arm]) -> list[Arm]:
        """Return the better half of the gaining arms, and new arms beside the best ones."""
        gaining = [arm for arm in self.race.abreast(arms) if self.race.gain(arm) > self.slack]
        kept = gaining[: (len(gaining) + 1) // 2]
        return list(dict.fromkeys([*kept, *(one for arm in kept[:REFINED] for one in self.race.around(arm))]))

    def _together(self, guard: Guard) -> Iterator[Candidate]:
        """If no single operand removes the loss, combine the best operand with others."""
        race = self.race
        ranked = race.ranked(arm for arm in race.gains if arm.guard == guard)
        if ranked and race.gain(ranked[0]) > self.slack:
            gains = {unit: {a.factor: race.gain(a) for a in ranked if a.unit == unit} for unit in self.units}
            joining = ForwardSelection(self.units, race.mutate, race.trials, self.goal, gains, self.slack)
            yield from joining.candidates(Joint(((ranked[0].unit, ranked[0].factor),), guard))


def arm_effects(race: Race) -> dict[str, list[OperandEffect]]:
    """For each site, return the best gain of each operand. On ties, the value that was tried first wins."""
    best: dict[Operand, OperandEffect] = {}
    for arm in race.gains:
        for mutation in arm.unit.mutations(race.mutate, arm.factor):
            gain = race.gain(arm)
            if mutation.operand not in best or gain > best[mutation.operand].effect:
                best[mutation.operand] = operand_effect(mutation, gain)
    found: dict[str, list[OperandEffect]] = {}
    for operand, effect in best.items():
        found.setdefault(str(operand.site), []).append(effect)
    return found
