"""Worlds as functions of a drift and a seed, with known results of stress runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pytest_tarl import Drift
from pytest_tarl.drifts import drift
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.seeds import episode_seeds, generator
from pytest_tarl.spaces import Point, Space
from pytest_tarl.stressing.combinations import Together
from pytest_tarl.stressing.evaluating import Evaluator
from pytest_tarl.stressing.findings import Curve, Stress
from pytest_tarl.stressing.guarantee import Guarantee
from pytest_tarl.stressing.rays import rays
from pytest_tarl.stressing.stress_run import explore, variances

World = Callable[[Point, np.random.Generator], tuple[bool, float]]  # → passed, total reward

_NONE = np.zeros(0, np.int32)


@dataclass
class Simulated:
    """A rollout of a world; `plans` are the episodes that ran."""

    world: World
    plans: list[EpisodePlan] = field(default_factory=list)
    workers: int = 1

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        self.plans.append(plan)
        assert plan.point is not None
        passed, total = self.world(plan.point, generator(plan.seed, "world"))
        trace = Trace((), _NONE, np.zeros(0), _NONE, _NONE, _NONE, np.array([total]), {})
        return EpisodeRun(plan, trace, passed)

    def begin(self, plan: EpisodePlan) -> Pending:
        return Deferred(self, plan)


def space_of(**directions: Any) -> Space:
    """Return a checked space."""
    found: Space = drift("t", "world", Drift.space(**directions)).value
    return found


def recorded(world: World, space: Space, rate: float = 0.95, tolerance: float = 0.5) -> Guarantee:
    """Return the guarantee of a recording of a hundred nominal episodes."""
    outcomes = [world(space.nominal, generator(seed, "world")) for seed in episode_seeds(7, "offline", 100)]
    totals = tuple(total for _, total in outcomes)
    return Guarantee(rate, tolerance, totals, sum(passed for passed, _ in outcomes) / 100)


def evaluator_of(world: World, space: Space, *, seed: int = 0, budget: int = 2000) -> Evaluator:
    """Return an evaluator of a world."""
    return Evaluator(Simulated(world), space, "world", recorded(world, space), seed, budget, lambda *_: None)


def stressed(
    world: World,
    space: Space,
    *,
    seed: int = 0,
    budget: int = 2000,
    variance: bool = False,
    combined: bool = True,
) -> Stress:
    """Run the stress search on a world, along single directions only unless `combined`."""
    evaluator = evaluator_of(world, space, seed=seed, budget=budget)
    curves = [Curve(ray) for ray in rays(space, {})]
    together = Together(0.01, curves)
    ended = explore(evaluator, together, together.risk, combined=combined)
    indices, ended = variances(evaluator, ended) if variance else (None, ended)
    return Stress(
        test="t",
        drift="world",
        seed=seed,
        space=space,
        guarantee=evaluator.guarantee,
        budget=budget,
        episodes=evaluator.spent,
        curves=tuple(curves),
        combinations=tuple(together.found),
        expected=tuple(together.expected),
        tried=together.tried,
        margin_map=together.margin_map,
        sobol=indices,
        ended=ended,
    )
