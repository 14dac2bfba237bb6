"""Search for drifts with low margins by CMA-ES, an evolution strategy (package `cma`)."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from math import nan

import numpy as np

from pytest_tarl.stressing.coordinates import Vector


def evolve(
    start: Vector, spread: float, draws: np.random.Generator, margin: Callable[[Vector], float | None]
) -> None:
    """Call `margin` with random vectors until it returns None; their normal distribution moves to low margins.

    `spread` is the initial standard deviation. `draws` provides the random numbers. Without it, `cma` would seed
    numpy's global generator, which nodes may use.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # cma warns if matplotlib is not installed
        import cma

        strategy = cma.CMAEvolutionStrategy(
            start, spread, {"verbose": -9, "seed": nan, "randn": lambda *shape: draws.standard_normal(shape)}
        )
        while not strategy.stop():
            vectors = strategy.ask()
            found = []
            for vector in vectors:
                one = margin(vector)
                if one is None:
                    return
                found.append(one)
            strategy.tell(vectors, found)
