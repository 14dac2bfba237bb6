"""The paper's search: ε-greedy SARSA over mutations, one mutation per episode; the state is the previous mutation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import fmean
from typing import TYPE_CHECKING

from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.search import (
    FACTORS,
    BudgetSpentError,
    Candidate,
    Goal,
    Mutate,
    Trials,
    operand_effect,
)
from tarl_lint.model import Operand

if TYPE_CHECKING:
    import numpy as np


class EpsilonGreedy:
    """Learn on fresh seeds which mutations gain most, then confirm the best ones on episodes that lost reward."""

    EPSILON = 0.2
    ALPHA = 0.3
    GAMMA = 0.5
    SITES = 3  # number of sites to search: the first ones in the ranking by program slices
    CONFIRMED = 3  # number of best mutations to confirm at the end
    EPISODES = 200

    @classmethod
    def episodes(cls, budget: int) -> int:
        """Return the number of episodes for learning. A third of the budget is left for confirmation and guards."""
        return max(1, min(cls.EPISODES, 2 * budget // 3))

    def __init__(
        self,
        operands: Sequence[Operand],
        mutate: Mutate,
        guards: Sequence[Guard],
        trials: Trials,
        goal: Goal,
        seeds: Sequence[int],
        generator: np.random.Generator,
    ) -> None:
        sites = list(dict.fromkeys(operand.site for operand in operands))[: self.SITES]
        tries = [mutate(o, f) for f in FACTORS for o in operands if o.site in sites]
        self.actions = [Candidate((m,), g) for g in guards for m in dict.fromkeys(tries) if m is not None]
        self.trials = trials
        self.goal = goal
        self.seeds = seeds
        self.generator = generator
        self.q: dict[tuple[int, int], float] = {}
        self.seen: dict[int, list[float]] = {}
        self.refused = set[int]()  # actions that cannot be written into the source

    def candidates(self) -> Iterator[Candidate]:
        """Learn on all seeds, then yield those of the best mutations that further episodes confirm."""
        if not self.actions:
            return
        self._learn()
        ranked = sorted(self.seen, key=lambda action: -fmean(self.seen[action]))
        for candidate in [self.actions[action] for action in ranked if action not in self.refused][
            : self.CONFIRMED
        ]:
            seed = self.goal.pairs[0].seed
            if self.goal.reached(self.trials(candidate, seed), seed) and confirmed(
                candidate, self.trials, self.goal, 0
            ):
                yield candidate

    def effects(self) -> dict[str, list[OperandEffect]]:
        """For each site, return the best mean gain of each operand over the mean reward of the drifted world."""
        best: dict[tuple[str, str], OperandEffect] = {}
        for action, totals in self.seen.items():
            if action in self.refused:
                continue
            mutation = self.actions[action].mutations[0]
            operand = mutation.operand
            effect = operand_effect(mutation, fmean(totals) - self.goal.online)
            key = (str(operand.site), operand.code)
            if key not in best or effect.effect > best[key].effect:
                best[key] = effect
        found: dict[str, list[OperandEffect]] = {}
        for (site, _), effect in best.items():
            found.setdefault(site, []).append(effect)
        return found

    def _learn(self) -> None:
        last, action = 0, self._choose(0)
        for seed in self.seeds:
            try:
                total = self.trials(self.actions[action], seed).total
            except RepairError:
                total = min(pair.total for pair in self.goal.pairs)
                self.refused.add(action)
            except BudgetSpentError:
                return
            self.seen.setdefault(action, []).append(total)
            following = self._choose(action)
            learned = self.q.get((last, action), total)
            ahead = self.q.get((action, following), total)
            reward = (1 - self.GAMMA) * total
            self.q[last, action] = learned + self.ALPHA * (reward + self.GAMMA * ahead - learned)
            last, action = action, following

    def _choose(self, state: int) -> int:
        """Return a random mutation with probability ε (1/2 while mutations are untried), else the best known one."""
        untried = [a for a in range(len(self.actions)) if a not in self.seen]
        if untried and self.generator.random() < 0.5:
            return untried[int(self.generator.integers(len(untried)))]
        if not self.seen or self.generator.random() < self.EPSILON:
            return int(self.generator.integers(len(self.actions)))
        return max(self.seen, key=lambda action: self.q.get((state, action), fmean(self.seen[action])))
