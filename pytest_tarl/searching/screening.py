"""Factorial screening for many operands: each run mutates a few at random; ridge regression finds the main effects.

The number of runs grows with the square root of the number of operands. The sweep then starts with the operands of the
best main effects. A run that nearly earns the designed reward becomes a candidate at once.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from math import ceil, sqrt

import numpy as np

from pytest_tarl.model import Guard
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.search import Candidate
from pytest_tarl.searching.units import NEAR, Unit

MANY = 40  # with at most this number of units, the sweep alone takes fewer episodes than screening and sweep
BLOCK = 20  # number of units per sweep after a screening
AT_ONCE = 4  # number of units mutated per run
RUNS = 6.0  # number of runs, as a multiple of the square root of the number of units
RIDGE = 1.0


def screened(
    together: ForwardSelection, guard: Guard, generator: np.random.Generator
) -> Generator[Candidate, None, tuple[Unit, ...]]:
    """Screen the units; return them, best main effect first. Yield the candidates that happen to be confirmed."""
    units = together.units
    drawn = [_drawn(units, generator) for _ in range(ceil(RUNS * sqrt(len(units))))]
    joints = [Joint(tuple((units[i], NEAR[turn]) for i, turn in one), guard) for one in drawn]
    design: list[np.ndarray] = []
    gains: list[float] = []
    for at, (joint, moved) in enumerate(zip(joints, drawn, strict=True)):
        together.expect(joints[at:])
        gained = yield from together.gain(joint)
        if gained is None:
            continue
        row = np.zeros(len(units) * len(NEAR))
        row[[i * len(NEAR) + turn for i, turn in moved]] = 1.0
        design.append(row)
        gains.append(gained)
    if not design:
        return tuple(units)
    effects = main_effects(np.array(design), np.array(gains)).reshape(len(units), len(NEAR)).max(axis=1)
    return tuple(units[i] for i in np.argsort(-effects, kind="stable").tolist())


def _drawn(units: Sequence[Unit], generator: np.random.Generator) -> list[tuple[int, int]]:
    """Draw the units that a run mutates, each with an index into `NEAR`."""
    chosen = generator.choice(len(units), AT_ONCE, replace=False).tolist()
    turns = generator.integers(len(NEAR), size=AT_ONCE).tolist()
    return list(zip(chosen, turns, strict=True))


def main_effects(design: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """Estimate by ridge regression how much each column of `design` contributes to the gains.

    `design` has shape (runs, columns), `gains` shape (runs,), the result shape (columns,).
    """
    size = design.shape[1]
    effects: np.ndarray = np.linalg.solve(design.T @ design + RIDGE * np.eye(size), design.T @ gains)
    return effects


def worth_screening(units: Sequence[Unit]) -> bool:
    """Return whether screening before the sweep takes fewer episodes than a sweep over all units."""
    return len(units) > MANY


def blocks(units: Sequence[Unit]) -> list[Sequence[Unit]]:
    """Split screened units into blocks, so that the best units are refined before the others are tried."""
    size = BLOCK if worth_screening(units) else max(len(units), 1)
    return [units[start : start + size] for start in range(0, len(units), size)]
