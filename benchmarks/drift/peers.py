"""Other searches with the same 200 episodes: random search, CMA-ES and Optuna, over all constants at once.

Each search proposes a factor for every operand (on a log scale, between a tenth and ten; signs and booleans
flip at random), and then receives the reward of one drifted episode with these factors. A proposal that comes
near the designed reward is tested on five more seeds; the first one that passes counts. With "our guard", a
mutation applies only where our method's first guard is true. The nominal world is not tested, since these
tools do not test it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from ours import judged

from pytest_tarl import seeds
from pytest_tarl.errors import RepairError
from pytest_tarl.model import Guard
from pytest_tarl.repairing import strategies
from pytest_tarl.repairing.mutants import Mutants
from pytest_tarl.repairing.request import Order
from pytest_tarl.searching import candidates
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Trials

BUDGET = 200
REACH = math.log(10.0)


class Optimiser(Protocol):
    """Proposes points in [-1, 1]ⁿ and receives their costs."""

    def ask(self) -> Sequence[float]:
        """Return the next point."""

    def tell(self, point: Sequence[float], cost: float) -> None:
        """Receive the cost of a point."""


class Random:
    """Random search: half of the coordinates keep their values, and the others are drawn at random."""

    def __init__(self, size: int, generator: np.random.Generator) -> None:
        self.size, self.generator = size, generator

    def ask(self) -> Sequence[float]:
        """Return the next point."""
        moved = self.generator.random(self.size) < 0.5
        return (moved * self.generator.uniform(-1.0, 1.0, self.size)).tolist()  # type: ignore[no-any-return]

    def tell(self, point: Sequence[float], cost: float) -> None:
        """Learn nothing."""


class Cma:
    """CMA-ES (`cma`), started at the unchanged node, with its default population size."""

    def __init__(self, size: int, generator: np.random.Generator) -> None:
        import cma

        options = {
            "verbose": -9,
            "seed": int(generator.integers(1, 2**31)),
            "bounds": [-1.0, 1.0],
            "CMA_diagonal": True,
        }
        self.strategy = cma.CMAEvolutionStrategy([0.0] * size, 0.3, options)
        self.waiting: list[Any] = []
        self.told: list[tuple[Any, float]] = []

    def ask(self) -> Sequence[float]:
        """Return the next point of the generation."""
        if not self.waiting:
            self.waiting = list(self.strategy.ask())
            self.told = []
        return self.waiting.pop()  # type: ignore[no-any-return]

    def tell(self, point: Sequence[float], cost: float) -> None:
        """Receive a cost; CMA-ES gets the costs of a whole generation at once."""
        self.told.append((point, cost))
        if not self.waiting:
            self.strategy.tell([p for p, _ in self.told], [c for _, c in self.told])


class Optuna:
    """Optuna's default sampler, TPE."""

    def __init__(self, size: int, generator: np.random.Generator) -> None:
        import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        sampler = optuna.samplers.TPESampler(seed=int(generator.integers(1, 2**31)))
        self.study = optuna.create_study(sampler=sampler)
        self.size = size
        self.trial: Any = None
        self.study.enqueue_trial({f"x{i}": 0.0 for i in range(size)})

    def ask(self) -> Sequence[float]:
        """Return the next point."""
        self.trial = self.study.ask()
        return [self.trial.suggest_float(f"x{i}", -1.0, 1.0) for i in range(self.size)]

    def tell(self, point: Sequence[float], cost: float) -> None:  # noqa: ARG002
        """Receive the cost of the last point."""
        self.study.tell(self.trial, cost)


OPTIMISERS: dict[str, Callable[[int, np.random.Generator], Optimiser]] = {
    "random": Random,
    "CMA-ES": Cma,
    "Optuna": Optuna,
}


def peer(order: Order, seed: int, name: str, guarded: bool) -> dict[str, Any]:
    """Search with another optimiser; return the restored reward and the cost."""
    mutants = Mutants(order)
    guard = _first_guard(order) if guarded else candidates.ALWAYS
    trials = Trials(lambda candidate, at: mutants.run(candidate, at, order.drift), BUDGET)
    operands = strategies.operands(order)
    optimiser = OPTIMISERS[name](len(operands), seeds.generator(seed, name))
    found = None
    try:
        while found is None:
            found = _turn(optimiser, operands, mutants, guard, trials, order)
    except BudgetSpentError:
        pass
    overlay = mutants.source(found) if found else None
    spent = {"comparison": order.online.recorded.sample.episodes, "search": trials.spent, "acceptance": 0}
    return {
        "ranked": [],
        "accepted": found is not None,
        "episodes": spent,
        "guard": "",
        **judged(order, overlay),
    }


def _turn(
    optimiser: Optimiser,
    operands: Sequence[Any],
    mutants: Mutants,
    guard: Guard,
    trials: Trials,
    order: Order,
) -> Candidate | None:
    """Try one point; return it if it is confirmed."""
    point = optimiser.ask()
    tried = [mutants.mutate(o, math.exp(REACH * x)) for o, x in zip(operands, point, strict=True)]
    kept = [
        mutation
        for mutation, x in zip(tried, point, strict=True)
        if mutation is not None and (x > 0.5 if isinstance(mutation.operand.value, bool) else abs(x) > 0.02)
    ]
    candidate = Candidate(tuple(kept), guard)
    first = len(trials.totals) % len(order.goal.pairs)
    seed = order.goal.pairs[first].seed
    try:
        outcome = trials(candidate, seed)
    except RepairError:
        optimiser.tell(point, -order.worst)
        return None
    optimiser.tell(point, -outcome.total)
    if kept and order.goal.reached(outcome, seed) and confirmed(candidate, trials, order.goal, first):
        return candidate
    return None


def _first_guard(order: Order) -> Guard:
    evidence = strategies.evidence(order)
    guards = candidates.candidate_guards(evidence)
    return candidates.telling(guards, evidence, strategies.MOST_GUARDS)[0]
