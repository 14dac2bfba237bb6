"""Streams of missions drawn from pools: a new recording for each, then designed or drifting missions."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from gate_examples import EXAMPLES, recorded
from gate_pools import simulated, trace
from gate_worlds import WORLDS
from numpy.typing import NDArray

from pytest_tarl.learning.bounds import Range
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.guarantees import stated, varies
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.packing import represented
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import END, Chain, Sample
from pytest_tarl.seeds import episode_seed, generator
from pytest_tarl.sensors import Sensor

OFFLINE = 200  # missions in a recording
# number of missions per pool: designed (True), drifted (False)
POOLED = {True: 3000, False: 1500}
POOLED_EXAMPLE = {True: 1000, False: 300}
FAILING = 0.03  # share of the designed missions, those with the smallest totals, that count as failed
Rows = NDArray[np.int64]
Generator = np.random.Generator


def constant(rng: Generator) -> tuple[list[tuple[int, ...]], list[float]]:
    """Draw a mission of fixed length that costs the same in every step."""
    return [(int(rng.integers(4)),) for _ in range(10)], [-0.1] * 10


def heavy(rng: Generator) -> tuple[list[tuple[int, ...]], list[float]]:
    """Draw a mission whose rewards are heavy-tailed, with infinite variance."""
    steps = int(rng.integers(1, 6))
    return [(int(one),) for one in rng.integers(3, size=steps)], (rng.pareto(1.1, steps) - 1.0).tolist()


def rare(rng: Generator) -> tuple[list[tuple[int, ...]], list[float]]:
    """Draw a mission of one step; one mission in fifty loses much reward."""
    return [(0,)], [-100.0 if rng.random() < 0.02 else 1.0]


SYNTHETIC: dict[str, Callable[[Generator], tuple[list[tuple[int, ...]], list[float]]]] = {
    "constant": constant,
    "heavy": heavy,
    "rare": rare,
}
UNBOUNDED = ("heavy",)  # worlds whose totals have no declared range
WATCHED = (*WORLDS, *EXAMPLES, *SYNTHETIC)


@dataclass(frozen=True)
class Pools:
    """A world's missions, as designed and at one size of the drift, with a common table of cells."""

    designed: Sample
    drifting: Sample


@cache
def pools(world: str, size: float) -> Pools:
    """Return a world's pools; a size of 0 means no drift.

    A mission succeeds if its total is above the designed totals' 3 % quantile.
    """
    designed, drifting = _pool(world, 0.0), _pool(world, size)
    least = float(np.quantile(designed.total, FAILING))
    cells = {*designed.cells, *drifting.cells}
    both = [merge([replace(one, passed=one.total >= least)], cells) for one in (designed, drifting)]
    return Pools(*both)


@cache
def _pool(world: str, size: float) -> Sample:
    if world in WORLDS:
        found = simulated(world, "hidden", size, POOLED[size == 0.0]).sample
    elif world in EXAMPLES:
        # a new process, because each example has its own module named `world`
        with ProcessPoolExecutor(1) as fresh:
            found = fresh.submit(recorded, world, size, POOLED_EXAMPLE[size == 0.0]).result().sample
    else:
        draws = (SYNTHETIC[world](generator(n, world)) for n in range(POOLED[True]))
        found = merge(
            [sample(trace(*one), episode_seed(0, world, n), True, ()) for n, one in enumerate(draws)]
        )
    return represented(replace(found, lists=()))


@cache
def total_range(world: str) -> Range | None:
    """Return a mission's range of totals, with or without drift, as a marker declares it, or None."""
    if world in UNBOUNDED:
        return None
    totals = [_pool(world, size).total for size in ((0.0, 1.0) if world not in SYNTHETIC else (0.0,))]
    low, high = min(float(one.min()) for one in totals), max(float(one.max()) for one in totals)
    return Range(float(np.floor(low)) - 1.0, float(np.ceil(high)) + 1.0)


def fixture(pool: Sample, rng: Generator, declared: Range | None = None) -> Fixture:
    """Return a recording of missions drawn with replacement, with the cells that they visit.

    The recording has the bounds of `--tarl-record`: on success and, with a declared range, on the mean.
    """
    chosen = gathered(pool, rng.integers(pool.episodes, size=OFFLINE))
    seen = np.unique(chosen.chain.cell)
    cells = tuple(pool.cells[row] for row in seen.tolist())
    seeds = tuple(sorted(int(one) for one in rng.integers(2**62, size=OFFLINE)))
    drawn = replace(_over(chosen, pool, cells), cells=cells, seeds=seeds)
    sensors = tuple(Sensor(f"s{n}") for n in range(len(cells[0])))
    told = stated(drawn.passed.tolist(), drawn.total.tolist(), declared=declared, varied=varies(drawn))
    return Fixture("stream", 0, sensors, (), {}, drawn, (), stated=told)


def stream(pool: Sample, cells: tuple[tuple[int, ...], ...], count: int, rng: Generator) -> Sample:
    """Return `count` missions drawn with replacement; all cells not in `cells` become one."""
    return _over(gathered(pool, rng.integers(pool.episodes, size=count)), pool, cells)


def gathered(pool: Sample, rows: Rows) -> Sample:
    """Return the missions in these rows, in order and with repetitions."""
    ends = np.searchsorted(pool.chain.episode, np.arange(pool.episodes + 1))
    lengths = (ends[1:] - ends[:-1])[rows]
    total = int(lengths.sum())
    begins = np.repeat(ends[rows] - (np.cumsum(lengths) - lengths), lengths)
    places = begins + np.arange(total)
    columns = {name: column[places] for name, column in vars(pool.chain).items()}
    episode = np.repeat(np.arange(len(rows)), lengths)
    return replace(
        pool,
        seeds=tuple(range(len(rows))),
        passed=pool.passed[rows],
        total=pool.total[rows],
        steps=pool.steps[rows],
        chain=Chain(**columns | {"episode": episode}),
    )


def _over(chosen: Sample, pool: Sample, cells: tuple[tuple[int, ...], ...]) -> Sample:
    """Return missions with cells numbered as in `cells`; all other cells get the next number."""
    number = {cell: row for row, cell in enumerate(cells)}
    place = np.array([*(number.get(cell, len(cells)) for cell in pool.cells), END], np.int64)
    chain = chosen.chain
    moved = replace(chain, cell=place[chain.cell], next_cell=place[chain.next_cell])
    return replace(chosen, cells=(*cells, ()), chain=moved)
