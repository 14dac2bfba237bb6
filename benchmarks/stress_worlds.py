"""Worlds of four directions, defined by formulas, in which the nearest failing drift is known except for noise.

The reward's noise depends on the seed, as in a simulation, with a quarter as much noise that also depends on the drift.
Each world takes a drift x in units of the ranges (0 is nominal) and random numbers, and returns whether the episode
passes, and its reward. The guarantee is that 95 % of the episodes pass and that at most TOLERANCE of the reward is
lost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.rollout import Deferred, EpisodePlan, EpisodeRun, Pending
from pytest_tarl.seeds import generator
from pytest_tarl.spaces import Space, Span

Vector = NDArray[np.float64]
World = Callable[[Vector, np.random.Generator], tuple[bool, float]]
TOLERANCE = 0.5
SHARED, NOISE = (
    0.2,
    0.05,
)  # standard deviations of the reward's noise: by seed alone, and by seed and drift
NAMES = ("a", "b", "c", "d")
_NONE = np.zeros(0, np.int32)


def plane(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward in proportion to three directions of different weight."""
    return True, 10.0 - TOLERANCE * float(np.abs(x) @ [1.2, 0.9, 0.6, 0.0]) / 0.8 + draws.normal(0.0, NOISE)


def product(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward if two directions change together; a third direction adds a little."""
    lost = 6.0 * x[0] * x[1] + 0.5 * abs(x[2])
    return True, 10.0 - TOLERANCE * float(lost) + draws.normal(0.0, NOISE)


def corner(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Fail if the sum of three directions is large; up to that point, the reward does not change."""
    return bool(np.abs(x[:3]).sum() + draws.normal(0.0, 0.03) < 1.2), 1.0


def ellipsoid(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward by a quadratic form whose axes are not the directions."""
    along, across = (x[0] + x[1] + x[2]) / np.sqrt(3), (x[0] - x[1]) / np.sqrt(2)
    lost = (along / 0.45) ** 2 + (across / 0.9) ** 2 + (x[3] / 0.8) ** 2
    return True, 10.0 - TOLERANCE * float(lost) + draws.normal(0.0, NOISE)


def rare(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Fail with a probability that grows smoothly with two directions and their product."""
    risk = 1.0 / (1.0 + np.exp(6.0 - 9.0 * abs(x[0]) - 6.0 * abs(x[1]) - 8.0 * abs(x[0] * x[1])))
    return bool(draws.random() > risk), 1.0


def island(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose reward only around a single drift, which no single direction approaches."""
    away = np.linalg.norm(x - [0.35, -0.35, 0.3, 0.0])
    return True, 10.0 - TOLERANCE * 2.0 * float(np.exp(-((away / 0.3) ** 2))) + draws.normal(0.0, NOISE)


def harmless(x: Vector, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose at most 62 % of the tolerated reward, and fail in 1 of 100 episodes everywhere."""
    _, total = plane(0.3 * x, draws)
    return bool(draws.random() < 0.99), total


WORLDS: Mapping[str, World] = {one.__name__: one for one in (plane, product, corner, ellipsoid, rare, island)}


def finished(plan: EpisodePlan, passed: bool, total: float) -> EpisodeRun:
    """Return an episode of a world without a node, which has only a result and a reward."""
    trace = Trace((), _NONE, np.zeros(0), _NONE, _NONE, _NONE, np.array([total]), {})
    return EpisodeRun(plan, trace, passed)


@dataclass(frozen=True)
class Formula:
    """A rollout of a world."""

    world: World
    workers = 1

    def __call__(self, plan: EpisodePlan) -> EpisodeRun:
        """Run one episode."""
        assert plan.point is not None
        passed, total = self.world(
            np.array(list(plan.point.values())), generator(plan.seed, f"world {plan.point}")
        )
        return finished(plan, passed, total + float(generator(plan.seed, "shared").normal(0.0, SHARED)))

    def begin(self, plan: EpisodePlan) -> Pending:
        """Return an episode that runs when its result is requested."""
        return Deferred(self, plan)


def space() -> Space:
    """Return four directions; two of them have positive and negative values."""
    spans = (Span(-0.5, 0.5, 0.0), Span(-0.5, 0.5, 0.0), Span(0.0, 1.0, 0.0), Span(0.0, 1.0, 0.0))
    return Space(dict(zip(NAMES, spans, strict=True)), {})
