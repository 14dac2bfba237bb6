"""Search for a mutation that restores the drifted world, by asking the drifted world.

`Sweep` is the default: one factor over all operands, paired with the unmutated run of the same seed, and whatever comes near
the off-line reward is confirmed on further seeds. `EpsilonGreedy` is the paper's: SARSA over mutations, one an
episode, the state being the last one. Both yield confirmed candidates; whether one is accepted is decided elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import sqrt
from statistics import fmean
from typing import TYPE_CHECKING

from pytest_tarl.accept import Outcome
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard, OperandEffect
from pytest_tarl.mutate import Mutation

if TYPE_CHECKING:
    import numpy as np

    from tarl_lint.model import Operand

Mutate = Callable[["Operand", float], Mutation | None]

FACTORS = (2.2, 0.4, 5.0, 0.15, 1.5, 0.65, 10.0)
CONFIRMATIONS = 5  # further seeds that a promising candidate must hold on


@dataclass(frozen=True)
class Candidate:
    """Mutations that hold together under one guard."""

    mutations: tuple[Mutation, ...]
    guard: Guard


@dataclass(frozen=True, slots=True)
class Pair:
    """An on-line episode that lost: its seed, and its total reward without any mutation."""

    seed: int
    total: float


@dataclass(frozen=True)
class Goal:
    """What the search is after. `near`: a total worth confirming; `enough`: a mean that confirms."""

    pairs: tuple[Pair, ...]
    near: float
    enough: float


class BudgetSpentError(Exception):
    """The search has used up its episodes."""


@dataclass
class Trials:
    """Runs candidates in the drifted world, each seed once, and keeps count and history."""

    run: Callable[[Candidate, int], Outcome]
    budget: int
    totals: list[float] = field(default_factory=list)
    labels: list[str] = field(default_factory=list)
    _known: dict[tuple[Candidate, int], Outcome] = field(default_factory=dict)

    def __call__(self, candidate: Candidate, seed: int) -> Outcome:
        """Run one episode, or remember it. Raises BudgetSpentError, or RepairError from writing the candidate."""
        key = (candidate, seed)
        if key not in self._known:
            if len(self.totals) >= self.budget:
                raise BudgetSpentError
            self._known[key] = self.run(candidate, seed)
            self.totals.append(self._known[key].total)
            self.labels.append(label(candidate))
        return self._known[key]

    @property
    def spent(self) -> int:
        """Return how many episodes were run."""
        return len(self.totals)


def label(candidate: Candidate) -> str:
    """Name a candidate's mutations for people: `line 30: 5 → 11.0`."""
    return ", ".join(
        f"line {m.operand.span.line}: {m.operand.code} → {m.value:.4g}"
        if m.operand.literal
        else f"line {m.operand.span.line}: {m.operand.code} × {m.value:.4g}"
        for m in candidate.mutations
    )


def confirmed(candidate: Candidate, trials: Trials, goal: Goal, first: int) -> bool:
    """Try further seeds, beginning after the pair `first`; drop the candidate at its second miss."""
    others = [goal.pairs[(first + i) % len(goal.pairs)] for i in range(1, len(goal.pairs))][:CONFIRMATIONS]
    totals: list[float] = []
    for pair in others:
        totals.append(trials(candidate, pair.seed).total)
        if sum(total < goal.near for total in totals) > 1:
            return False
    return not totals or fmean(totals) >= goal.enough


class Sweep:
    """Sweep and confirm, operands in the given order, each mutated at its use under `guard`."""

    def __init__(
        self, operands: Sequence[Operand], mutate: Mutate, guard: Guard, trials: Trials, goal: Goal
    ) -> None:
        self.operands = operands
        self.mutate = mutate
        self.guard = guard
        self.trials = trials
        self.goal = goal
        self._gains: dict[Operand, dict[float, float]] = {operand: {} for operand in operands}
        self._factors: dict[Operand, dict[float, float]] = {operand: {1.0: 0.0} for operand in operands}
        self._tried: set[Mutation] = set()

    def candidates(self) -> Iterator[Candidate]:
        """Yield candidates that hold on every seed they were tried on."""
        for turn, factor in enumerate(FACTORS):
            pair = turn % len(self.goal.pairs)
            for operand in self.operands:
                yield from self._try(operand, factor, pair)
            yield from self._refine(pair)

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, per site, what each operand's best value gained over the unmutated run of the same seed."""
        found: dict[str, list[OperandEffect]] = {}
        for operand, gains in self._gains.items():
            if gains:
                best = max(gains, key=gains.__getitem__)
                effect = OperandEffect(operand.code, _number(operand.value), best, gains[best])
                found.setdefault(str(operand.site), []).append(effect)
        return found

    def _try(self, operand: Operand, factor: float, pair: int) -> Iterator[Candidate]:
        mutation = self.mutate(operand, factor)
        if mutation is None or mutation in self._tried:
            return
        self._tried.add(mutation)
        candidate = Candidate((mutation,), self.guard)
        base = self.goal.pairs[pair]
        try:
            total = self.trials(candidate, base.seed).total
        except RepairError:
            return
        self._gains[operand][float(mutation.value)] = total - base.total
        self._factors[operand][factor] = total - base.total
        if total >= self.goal.near and confirmed(candidate, self.trials, self.goal, pair):
            yield candidate

    def _refine(self, pair: int) -> Iterator[Candidate]:
        """Try the most improving operand between its best factor and that factor's neighbours, on a log scale."""
        best = max(self.operands, key=lambda operand: max(self._factors[operand].values()), default=None)
        if best is None:
            return
        gains = self._factors[best]
        factor = max(gains, key=gains.__getitem__)
        if factor == 1.0 or gains[factor] <= 0:
            return
        ordered = sorted(gains)
        place = ordered.index(factor)
        for neighbour in ordered[max(place - 1, 0) : place] + ordered[place + 1 : place + 2]:
            yield from self._try(best, round(sqrt(factor * neighbour), 3), pair)


class EpsilonGreedy:
    """The paper's search: SARSA over mutations, ε-greedy, one mutation an episode, state = the last mutation."""

    EPSILON = 0.2
    ALPHA = 0.3
    GAMMA = 0.5
    SITES = 3  # the sites that the slices rank first
    CONFIRMED = 3  # how many of the best mutations are confirmed in the end

    def __init__(
        self,
        operands: Sequence[Operand],
        mutate: Mutate,
        guard: Guard,
        trials: Trials,
        goal: Goal,
        seeds: Sequence[int],
        generator: np.random.Generator,
    ) -> None:
        sites = list(dict.fromkeys(operand.site for operand in operands))[: self.SITES]
        tries = [mutate(o, f) for f in FACTORS for o in operands if o.site in sites]
        self.actions = [Candidate((m,), guard) for m in dict.fromkeys(tries) if m is not None]
        self.trials = trials
        self.goal = goal
        self.seeds = seeds
        self.generator = generator
        self.q: dict[tuple[int, int], float] = {}
        self.seen: dict[int, list[float]] = {}

    def candidates(self) -> Iterator[Candidate]:
        """Learn for all seeds, then yield the best mutations that confirm."""
        if not self.actions:
            return
        self._learn()
        ranked = sorted(self.seen, key=lambda action: -fmean(self.seen[action]))
        for action in ranked[: self.CONFIRMED]:
            if confirmed(self.actions[action], self.trials, self.goal, 0):
                yield self.actions[action]

    def effects(self) -> dict[str, list[OperandEffect]]:
        """Return, per site, the mean gain of the best mutation of each operand over the unmutated world."""
        base = fmean(pair.total for pair in self.goal.pairs)
        best: dict[tuple[str, str], OperandEffect] = {}
        for action, totals in self.seen.items():
            mutation = self.actions[action].mutations[0]
            operand = mutation.operand
            effect = OperandEffect(
                operand.code, _number(operand.value), float(mutation.value), fmean(totals) - base
            )
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
        """Explore with probability ε and while something is untried, else take the best known mutation."""
        untried = [a for a in range(len(self.actions)) if a not in self.seen]
        if untried and self.generator.random() < 0.5:
            return untried[int(self.generator.integers(len(untried)))]
        if not self.seen or self.generator.random() < self.EPSILON:
            return int(self.generator.integers(len(self.actions)))
        return max(self.seen, key=lambda action: self.q.get((state, action), fmean(self.seen[action])))


def _number(value: float | None) -> float | None:
    return None if value is None else float(value)
