"""Pools of episodes to draw from: the statistics of many missions of one world at one size of a drift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np
from gate_worlds import WORLDS, Log

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Chain, Sample
from pytest_tarl.seeds import episode_seed, generator
from pytest_tarl.sensors import Cell

Mode = Literal["hidden", "harmless", "novel"]
MODES: tuple[Mode, ...] = ("hidden", "harmless", "novel")


@dataclass(frozen=True)
class Pool:
    """Episodes of a world at one size of its drift; `changed` has the cells that the drift changes.

    A cell counts as changed if the drift is active in at least half of the steps there.
    """

    sample: Sample
    changed: frozenset[Cell]


def simulated(world: str, mode: Mode, drift: float, episodes: int) -> Pool:
    """Run missions of a small world in which a sensor shows, in one of three ways, where the drift is active.

    The sensor is hidden (not part of the comparison), harmless (with the same values in both worlds), or novel (true
    only where the drift is active).
    """
    samples, exposed = [], dict[Cell, list[bool]]()
    for index in range(episodes):
        log = WORLDS[world](generator(index, f"{world}/{drift}"), drift)
        cells = seen(log, mode, drift)
        samples.append(sample(trace(cells, log.reward), episode_seed(0, f"{world}/{drift}", index), True, ()))
        for cell, acts in zip(cells, log.exposed, strict=True):
            exposed.setdefault(cell, []).append(acts)
    changed = frozenset(cell for cell, acts in exposed.items() if np.mean(acts) >= 0.5)
    return Pool(merge(samples), changed)


def seen(log: Log, mode: Mode, drift: float) -> list[Cell]:
    """Return each step's cell as seen by the comparison."""
    if mode == "hidden":
        return list(log.bins)
    visible = mode == "harmless" or drift > 0
    return [(*bins, int(acts and visible)) for bins, acts in zip(log.bins, log.exposed, strict=True)]


def trace(cells: Sequence[Cell], reward: Sequence[float]) -> Trace:
    """Return a mission without events: its sensor cells and rewards."""
    distinct = tuple(dict.fromkeys(cells))
    number = {cell: i for i, cell in enumerate(distinct)}
    none = np.empty(0, dtype=np.int32)
    step_cell = np.array([number[cell] for cell in cells], dtype=np.int32)
    return Trace(distinct, none, np.empty(0), none, none, step_cell, np.array(reward), {})


def drawn(pool: Sample, rows: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Sample:
    """Return the episodes in `rows`, in the order of the pool."""
    rows = np.sort(rows)
    place = np.full(pool.episodes, -1, dtype=np.int64)
    place[rows] = np.arange(rows.size)
    kept = place[pool.chain.episode] >= 0
    columns = {f.name: getattr(pool.chain, f.name)[kept] for f in fields(Chain)}
    return replace(
        pool,
        seeds=tuple(pool.seeds[row] for row in rows.tolist()),
        passed=pool.passed[rows],
        total=pool.total[rows],
        steps=pool.steps[rows],
        chain=Chain(**columns | {"episode": place[columns["episode"]]}),
    )
