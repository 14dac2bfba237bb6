"""Measure the false discovery rate of the robots that `tarl fleet` reports, over many simulated fleets.

    python benchmarks/fleet_false_discoveries.py [--fleets 100] [--robots 100] [--missions 60]

Each fleet has its own recording of the world in benchmarks/fleet.py. In the first half of the fleets, a tenth of the
robots drift from a random mission on: a place costs reward, and 15 % of the missions fail. In the second half, no robot
drifts, so a fleet's share of false discoveries is 1 if any robot is reported. The missions' statistics are random
numbers, judged by the functions that `tarl fleet` calls. For comparison, the z-score of each robot's mean reward is
computed; |z| > 3 is an alarm.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from statistics import mean, stdev
from tempfile import TemporaryDirectory

import numpy as np
from fleet import ALARM, PLACES, recording

from pytest_tarl.fleet import changed_robots
from pytest_tarl.fleet.dask_tasks import local
from pytest_tarl.fleet.partitions import bare, watched_chain
from pytest_tarl.fleet.scores import Scores
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.tables import END, Chain, Ints, Sample
from pytest_tarl.monitoring.monitor import begun
from pytest_tarl.monitoring.scores import Scale, binned
from pytest_tarl.seeds import generator

Q = 0.05
SHARE = 10  # one robot in `SHARE` drifts
METHODS = ("missions differ", "below a bound", "z-score")


def drawn(
    rng: np.random.Generator, drifted: np.ndarray[tuple[int], np.dtype[np.bool_]], cells: int
) -> Sample:
    """Return missions like those of `drive` in benchmarks/fleet.py; in the `drifted` ones, a place costs reward."""
    count = len(drifted)
    wet = rng.random(count) < 0.3
    stays = rng.random((count, PLACES)) < 0.5
    first, second = rng.normal(1.0, 0.3, (2, count, PLACES))
    lost = 0.5 * (drifted[:, None] & (np.arange(PLACES) == 6))
    first, second = first - lost, second - lost
    cell = 2 * np.arange(PLACES) + wet[:, None]
    episode = np.broadcast_to(np.arange(count)[:, None], cell.shape)
    onward = np.where(np.arange(PLACES) == PLACES - 1, END, cell + 2)
    rows = [
        np.concatenate([one[stays], other.ravel()])
        for one, other in (
            (episode, episode),
            (cell, cell),
            (cell, onward),
            (first, np.where(stays, second, first)),
        )
    ]
    order = np.lexsort((rows[2], rows[1], rows[0]))
    episodes, places, following = (one[order].astype(np.int64) for one in rows[:3])
    none = np.zeros((order.size, 0))
    chain = Chain(episodes, places, following, np.ones(order.size, np.int64), rows[3][order], none)
    passed = rng.random(count) >= 0.002 + 0.15 * drifted
    total = first.sum(axis=1) + (second * stays).sum(axis=1)
    steps = PLACES + stays.sum(axis=1)
    return bare(cells + 1, passed, total, steps, watched_chain(chain, cells))


def scored(sample: Sample, scale: Scale, missions: int) -> Scores:
    """Return the missions with their scores."""
    none = np.empty(0, np.int64)
    time = np.tile(np.arange(missions, dtype=np.float64), sample.episodes // missions)
    bins = binned(scale, sample).astype(np.int8)
    return Scores(sample.passed, sample.total, sample.steps, time, bins, none, none, ())


def named(fixture: Fixture, sample: Sample, count: int, missions: int) -> dict[str, set[int]]:
    """Return the robots that each method reports."""
    first = begun(fixture, alpha=Q, seed=0)
    names = [str(number) for number in range(count)]
    ends: Ints = np.arange(1, count + 1) * missions
    with local(1) as engine:
        every = tuple(
            changed_robots.watched(first, scored(sample, first.scale, missions), names, ends, engine, Q)
        )
    told = changed_robots.named(every, Q)
    recorded = fixture.sample.total
    averages = sample.total.reshape(count, missions).mean(axis=1)
    z = (averages - recorded.mean()) / recorded.std(ddof=1) / np.sqrt(1 / missions + 1 / recorded.size)
    found = {int(one.name) for one in told.drifted}, {int(one.name) for one in told.below}
    return dict(zip(METHODS, (*found, {*np.flatnonzero(np.abs(z) > ALARM).tolist()}), strict=True))


def told(kind: str, truth: Sequence[set[int]], found: Sequence[dict[str, set[int]]]) -> None:
    """Print a row for each method."""
    for method in METHODS:
        shares = [
            len(one[method] - true) / max(1, len(one[method])) for one, true in zip(found, truth, strict=True)
        ]
        right = sum(len(one[method] & true) for one, true in zip(found, truth, strict=True))
        wrong = sum(len(one[method] - true) for one, true in zip(found, truth, strict=True))
        error = stdev(shares) / len(shares) ** 0.5
        drifted = sum(map(len, truth))
        print(
            f"| {kind} | {method} | {right} of {drifted} | {wrong} | {100 * mean(shares):.1f} % ± {100 * error:.1f} |"
        )


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fleets", type=int, default=100, help="of each kind")
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--missions", type=int, default=60, help="of each robot")
    order = parser.parse_args()
    print(
        f"| fleets, q = {100 * Q:g} % | method | right | wrong | mean share of wrong names |\n|---|---|---|---|---|"
    )
    with TemporaryDirectory() as folder:
        for kind in ("a tenth drifts", "none drifts"):
            truth, found = [], []
            for number in range(order.fleets):
                seed = 2 * number + (kind == "none drifts")
                fixture = recording(Path(folder) / "test.npz", seed)
                rng = generator(seed, "fleet/many")
                size = order.robots // SHARE if kind == "a tenth drifts" else 0
                drifting = {*rng.choice(order.robots, size, replace=False).tolist()}
                onset = rng.integers(int(0.2 * order.missions), int(0.6 * order.missions), order.robots)
                late = np.arange(order.missions) >= onset[:, None]
                drifted = late & np.isin(np.arange(order.robots), [*drifting])[:, None]
                sample = drawn(rng, drifted.ravel(), len(fixture.sample.cells))
                truth.append(drifting)
                found.append(named(fixture, sample, order.robots, order.missions))
            told(kind, truth, found)


if __name__ == "__main__":
    main()
