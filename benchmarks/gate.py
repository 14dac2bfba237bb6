"""Measure, in many repetitions, how often the verdict is a false alarm or finds a drift, and how well the region fits.

    python benchmarks/gate.py [--repetitions 500] [--worlds track lane …] [--sizes 0 0.2 1]

The worlds are eight small ones and the two examples. A pool of missions is simulated for each world, each way in which
a sensor can show the drift, and each size of the drift. Pairs of samples (designed, drifted) are then drawn repeatedly
from the pools and compared. Two reference methods run on the same samples: a two-sample Kolmogorov-Smirnov test of the
total reward, and an alarm if the mean total reward falls by more than 10 %.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from statistics import fmean

import numpy as np
from gate_examples import EXAMPLES, recorded
from gate_pools import MODES, Mode, Pool, drawn, simulated
from gate_worlds import WORLDS
from scipy.stats import ks_2samp

from pytest_tarl import seeds
from pytest_tarl.learning.drift import compare
from pytest_tarl.learning.tables import Sample
from pytest_tarl.sensors import Cell

ALPHA = 0.05
SIZES = (0.0, 0.1, 0.2, 0.5, 1.0)
OFFLINE, ONLINE = 200, 40
# number of missions per pool: designed (True), drifted (False)
POOLED = {True: 3000, False: 1500}
POOLED_EXAMPLE = {True: 1000, False: 300}


@dataclass(frozen=True)
class Seen:
    """The results of one comparison, and of the reference methods on the same samples."""

    degraded: bool
    drift: bool
    kolmogorov: bool
    threshold: bool
    held: float  # of the visited cells that the drift changes, the share in the reported region
    others: int  # number of cells in the reported region that the drift does not change


@dataclass(frozen=True)
class Row:
    """The repetitions for one world, one way of showing its drift, and one size of the drift."""

    world: str
    mode: str
    size: float
    seen: tuple[Seen, ...]

    def share(self, what: str) -> float:
        """Return the share of repetitions with a positive result."""
        return fmean(getattr(one, what) for one in self.seen)


def pools(world: str, mode: Mode, sizes: Sequence[float]) -> dict[float, Pool]:
    """Return a pool for each size of the drift."""
    if world in WORLDS:
        return {size: simulated(world, mode, size, POOLED[size == 0.0]) for size in sizes}
    return {size: recorded(world, size, POOLED_EXAMPLE[size == 0.0]) for size in sizes}


def rows(world: str, mode: Mode, repetitions: int, sizes: Sequence[float] = SIZES) -> list[Row]:
    """Compare repeatedly, at each size of the drift."""
    pool = pools(world, mode, sizes)
    designed = pool[0.0].sample
    found = []
    for size, there in pool.items():
        judged = []
        for repetition in range(repetitions):
            draws = seeds.generator(repetition, f"{world}/{mode}/{size}")
            order = draws.permutation(designed.episodes)
            # without a drift, both samples come from the same pool and must not share a mission
            chosen = order[-ONLINE:] if size == 0.0 else draws.permutation(there.sample.episodes)[:ONLINE]
            recordings = drawn(designed, order[:OFFLINE]), drawn(there.sample, chosen)
            judged.append(_judged(*recordings, there.changed, draws))
        found.append(Row(world, mode, size, tuple(judged)))
    return found


def _judged(before: Sample, after: Sample, changed: frozenset[Cell], draws: np.random.Generator) -> Seen:
    found = compare(before, after, alpha=ALPHA, tolerance=None, generator=draws)
    region = {*found.region.cells, *found.region.novel}
    visited = changed & {after.cells[i] for i in np.unique(after.chain.cell).tolist()}
    loss = before.total.mean() - after.total.mean()
    return Seen(
        degraded=found.verdict.result == "degraded",
        drift=found.verdict.p_drift < ALPHA,
        kolmogorov=bool(ks_2samp(before.total, after.total).pvalue < ALPHA),
        threshold=bool(loss > 0.1 * abs(before.total.mean())),
        held=len(region & visited) / len(visited) if visited else 0.0,
        others=len(region - changed),
    )


HEADING = """\
| world | the drift's sensor | size | degraded | p_drift | KS | 10 % | changed cells held | others |
|---|---|---|---|---|---|---|---|---|"""


def line(row: Row) -> str:
    """Return a row of the Markdown table; shares in percent."""
    region = (f"{row.share('held'):.0%}", f"{row.share('others'):.1f}") if row.size else ("", "")
    said = [f"{row.share(what):.1%}" for what in ("degraded", "drift", "kolmogorov", "threshold")]
    return f"| {row.world} | {row.mode} | {row.size:g} | {' | '.join((*said, *region))} |"


def summary(found: Sequence[Row]) -> str:
    """Return the means over all worlds, by mode and size."""
    lines = ["| the drift's sensor | size | degraded | p_drift | KS | 10 % |", "|---|---|---|---|---|---|"]
    for mode, size in dict.fromkeys((row.mode, row.size) for row in found):
        alike = [row for row in found if (row.mode, row.size) == (mode, size)]
        said = [
            f"{fmean(row.share(what) for row in alike):.1%}"
            for what in ("degraded", "drift", "kolmogorov", "threshold")
        ]
        lines.append(f"| {mode} | {size:g} | {' | '.join(said)} |")
    return "\n".join(lines)


def main() -> None:
    """Run the comparisons in every world, with two processes in parallel."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--repetitions", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--worlds", nargs="+", default=[*WORLDS, *EXAMPLES], choices=[*WORLDS, *EXAMPLES])
    parser.add_argument(
        "--sizes", nargs="+", type=float, default=SIZES, help="sizes of the drift; 0 means no drift"
    )
    arguments = parser.parse_args()
    asked = [
        *product([name for name in arguments.worlds if name in WORLDS], MODES),
        *((name, EXAMPLES[name].mode) for name in arguments.worlds if name in EXAMPLES),
    ]
    with ProcessPoolExecutor(arguments.workers) as processes:
        jobs = [processes.submit(rows, *one, arguments.repetitions, arguments.sizes) for one in asked]
        print(HEADING, flush=True)
        found = []
        for job in jobs:
            found += job.result()
            print(*map(line, job.result()), sep="\n", flush=True)
    print("", summary(found), sep="\n")


if __name__ == "__main__":
    main()
