"""Measure what it costs to compute statistics from a buffer and the utility from statistics, and how this grows.

    python benchmarks/statistics_cost.py            # about a minute
    python benchmarks/statistics_cost.py --workers  # also records with one and two worker processes

The file is not named statistics.py, which would shadow the standard module for scripts in this folder. Times are CPU
times of this process, the minimum of several; the speed-up by workers is in wall time.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.learning.utility import batch, chain_utility
from pytest_tarl.model import SitePlace, TaintList
from pytest_tarl.sensors import Sensor

SITES = 12
REPEATS = 5
GROWTH = (1, 2, 4, 8)
RECORDINGS = (
    ("shuttle", "test_shuttle.py::test_delivers", 200),
    ("shuttle", "test_shuttle.py::test_delivers", 1000),
    ("quadrotor", "test_quadrotor.py", 100),
    ("quadrotor", "test_quadrotor.py", 400),
)


def main() -> None:
    """Print every table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--workers", action="store_true", help="also measure two worker processes")
    arguments = parser.parse_args()
    print("| what | measured | goal |\n|---|---|---|")
    for line in (*throughput(), *solving()):
        print(line)
    print("\n| | 1× | 2× | 4× | 8× |\n|---|---|---|---|---|")
    for line in growth():
        print(line)
    if arguments.workers:
        print(
            "\n| recording | CPU s of the run | of its workers | wall s | speed-up |\n|---|---|---|---|---|"
        )
        for line in speed_up():
            print(line)


def throughput(events: int = 1_000_000) -> Iterator[str]:
    """Measure the throughput from a recorder's buffer to an episode's statistics."""
    steps = events // SITES
    recorder = recorded(steps)
    whole = least(lambda: sample(recorder().finish(), 0, True, [range(SITES)]))
    filling = least(recorder)
    trace = recorder().finish()
    counting = least(lambda: sample(trace, 0, True, [range(SITES)]))
    rate = events / (whole - filling) / 1e6
    yield f"| buffer → statistics, {events:,} events | {rate:.1f} M events/s | ≥ 10 |"
    yield f"| of which trace → statistics | {events / counting / 1e6:.1f} M events/s | |"


def recorded(steps: int) -> Callable[[], Recorder]:
    """Return a factory of recorders with `steps` steps of events in the buffer."""
    draws = np.random.default_rng(0)
    cells = np.abs(np.cumsum(draws.integers(-1, 2, steps))) % 48
    rewards = draws.normal(size=steps).tolist()
    chunks = [[x for n in range(SITES) for x in (n, float(n) + reward)] for reward in rewards]

    def fill() -> Recorder:
        recorder = Recorder()
        entries = recorder._entries()
        for cell, chunk, reward in zip(cells.tolist(), chunks, rewards, strict=True):
            recorder.latch((cell,))
            entries.extend(chunk)
            recorder.reward(reward)
        return recorder

    return fill


def solving() -> Iterator[str]:
    """Measure how long it takes to compute the utility from all episodes at once."""
    chained = walk(episodes=200, steps=400, cells=2000, sites=0)
    measured = least(lambda: chain_utility(chained.chain, 2000)) * 1e3
    seen = len(np.unique(chained.chain.cell))
    yield f"| solve U(x), {seen:,} cells, {chained.chain.cell.size:,} transitions | {measured:.1f} ms | ≤ 5 |"
    listed = walk(episodes=200, steps=400, cells=170, sites=SITES)
    states = len(np.unique(listed.lists[0].edges.state))
    solved = least(lambda: batch(listed.lists[0], 170, 1.0)) * 1e3
    yield f"| solve q(x, n), {states:,} states | {solved:.1f} ms | ≤ 5 |"


def growth() -> Iterator[str]:
    """Measure how time, peak memory and file size grow with the number of events, cells, lists and episodes."""
    base = {"episodes": 50, "steps": 400, "cells": 50, "lists": 1}
    for grown, label in (
        ("steps", "events"),
        ("cells", "cells"),
        ("lists", "lists"),
        ("episodes", "episodes"),
    ):
        rows = [cost(**base | {grown: base[grown] * factor}) for factor in GROWTH]
        for position, what in enumerate(("ms to count and merge", "ms to solve", "peak MB", "fixture kB")):
            figures = " | ".join(f"{row[position]:.3g}" for row in rows)
            yield f"| {label}: {what} | {figures} |"


def cost(episodes: int, steps: int, cells: int, lists: int) -> tuple[float, float, float, float]:
    """Return the ms to count events and compute the utility, the peak memory (MB), and the recording's size (kB)."""
    traces = [episode(seed, steps, cells, SITES) for seed in range(episodes)]
    members = [range(SITES)] * lists

    def counted() -> Sample:
        return merge([sample(trace, seed, True, members) for seed, trace in enumerate(traces)])

    whole = counted()
    counting = least(counted, repeats=2)
    solved = least(lambda: [batch(one, len(whole.cells), 1.0) for one in whole.lists], repeats=2)
    tracemalloc.start()
    counted()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return counting * 1e3, solved * 1e3, peak / 1e6, stored(whole) / 1e3


def stored(whole: Sample) -> int:
    """Return the size of the recording in bytes."""
    places = tuple(SitePlace(f"s{n}", "node.py", n, f"x = {n}", "data", "assign") for n in range(SITES))
    lists = tuple(TaintList(f"/in{i}", "/out", places) for i in range(len(whole.lists)))
    tables = tuple(np.full((len(whole.cells), SITES), np.nan) for _ in lists)
    fixture = Fixture("test", 0, (Sensor("x"),), lists, {}, whole, tables)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.npz")
        save(fixture, path)
        load(path)
        return path.stat().st_size


def walk(episodes: int, steps: int, cells: int, sites: int) -> Sample:
    """Return many episodes of a random walk over cells."""
    members = [range(sites)] if sites else []
    return merge(
        [sample(episode(s, steps, cells, max(sites, 1)), s, True, members) for s in range(episodes)],
        cells=[(i,) for i in range(cells)],
    )


def episode(seed: int, steps: int, cells: int, sites: int) -> Trace:
    """Return an episode whose steps visit all sites, each step in a cell near the previous one."""
    draws = np.random.default_rng(seed)
    cell = (draws.integers(cells) + np.cumsum(draws.integers(-1, 2, steps))) % cells
    names, place = np.unique(cell, return_inverse=True)
    place = place.astype(np.int32)
    return Trace(
        cells=tuple((int(name),) for name in names),
        site=np.tile(np.arange(sites, dtype=np.int32), steps),
        flow=np.abs(draws.normal(size=steps * sites)),
        event_cell=np.repeat(place, sites),
        event_step=np.repeat(np.arange(steps, dtype=np.int32), sites),
        step_cell=place,
        reward=draws.normal(size=steps),
        parts={},
    )


def speed_up() -> Iterator[str]:
    """Record the examples in one process and with two workers.

    With two free cores, the speed-up is the ratio of wall times. CPU times of the main process and its workers do not
    depend on other load. With one core per worker, a run takes the main process's CPU time plus half of the workers'.
    """
    for example, test, episodes in RECORDINGS:
        what = f"{example}, {episodes} episodes"
        whole, _, wall = recorded_example(example, test, episodes, 1)
        yield f"| {what}, here | {whole:.1f} | | {wall:.1f} | |"
        own, theirs, took = recorded_example(example, test, episodes, 2)
        ratio = f"{whole / (own + theirs / 2):.2f} by CPU, {wall / took:.2f} by wall"
        yield f"| {what}, 2 workers | {own:.1f} | {theirs:.1f} | {took:.1f} | {ratio} |"


def recorded_example(example: str, test: str, episodes: int, workers: int) -> tuple[float, float, float]:
    """Return CPU seconds of a recording and of its workers, and wall seconds, without pytest's start."""
    source = Path(__file__).resolve().parent.parent / "examples" / example
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder, example)
        shutil.copytree(source, root, ignore=shutil.ignore_patterns(".tarl", "__pycache__"))
        flags = ["-q", "-p", "no:cacheprovider", test, "--tarl-record"]
        flags += [f"--tarl-episodes={episodes}", f"--tarl-workers={workers}"]
        told = subprocess.run(
            [sys.executable, "-c", MEASURED, *flags], cwd=root, check=True, capture_output=True, text=True
        )
    own, theirs, wall = map(float, told.stdout.rpartition("MEASURED")[2].split())
    return own, theirs, wall


def least(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the minimum CPU time of several runs in seconds."""
    times = []
    for _ in range(repeats):
        before = time.process_time()
        work()
        times.append(time.process_time() - before)
    return min(times)


MEASURED = """
import sys, time
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
import numpy, pytest, pytest_tarl.session
def cpu(who):
    used = getrusage(who)
    return used.ru_utime + used.ru_stime
own, wall = cpu(RUSAGE_SELF), time.perf_counter()
code = pytest.main(sys.argv[1:])
print("MEASURED", cpu(RUSAGE_SELF) - own, cpu(RUSAGE_CHILDREN), time.perf_counter() - wall)
sys.exit(code)
"""

if __name__ == "__main__":
    main()
