"""Measure time and memory at very large sizes: whether they grow in proportion to the size, and where the limit is.

`python benchmarks/limits.py` runs each case at increasing sizes, each in its own process. It prints CPU seconds and
peak resident memory, in total and per unit. `--share 1` goes up to 10⁶ messages per episode, messages of 100 MB, 10,000
sites, 10⁵ cells and a recording of 2 GB; smaller shares stop earlier. The exit status is 1 if time or memory per unit
more than triples from the second size to the last (from the first to the second if there are only two).
"""

from __future__ import annotations

import argparse
import copy
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from pytest_tarl import Sensor
from pytest_tarl.errors import TarlError
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.learning.drift import compare
from pytest_tarl.learning.fixture import Fixture, load, save
from pytest_tarl.learning.footprint import Footprint
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import SitePlace, TaintList
from pytest_tarl.ros import Ros, message_type

EPISODE = 12_800  # bytes per episode in the file of the case `recording`
WORSE = 3.0  # maximum growth of time or memory per unit from the second size to the last
NODE = """
import rospy
from std_msgs.msg import {kind}
def heard(message):
    out.publish(message)
rospy.init_node("echo")
out = rospy.Publisher("/out", {kind}, queue_size=1)
rospy.Subscriber("/in", {kind}, heard)
rospy.spin()
"""


def messages(size: int) -> str:
    """Publish `size` messages to a node that answers each one."""
    return echo("Float64", [1.5] * size)


def megabytes(size: int) -> str:
    """Publish three messages of `size` MB each."""
    return echo("UInt8MultiArray", [b"\1" * (size * 1_000_000)] * 3)


def echo(kind: str, values: list[object]) -> str:
    """Run a node that publishes each message it receives."""
    made = message_type(f"std_msgs/{kind}")
    ros = Ros()
    with ros.installed():
        code = compile(NODE.format(kind=kind), "<echo>", "exec")
        ros.start(lambda: exec(code, {"__name__": "__main__"}), name="echo")  # noqa: S102
        for value in values:
            ros.bus.publish("/in", made(data=value))
            ros.step(0.01)
        count = ros.bus.published["/out"]
        ros.close()
    assert count == len(values), count
    return f"{count:,} answers"


def events(size: int) -> str:
    """Record `size` events in one episode, and compute the statistics."""
    recorder = Recorder()
    for number in range(size // 20):
        recorder.latch((number % 50,))
        for site in range(20):
            recorder.hook(site, 0.5)
        recorder.reward(1.0)
    trace = recorder.finish()
    sample(trace, 0, True, [range(20)])
    return f"{trace.site.size:,} events"


def sites(size: int) -> str:
    """Compare two worlds with `size` recorded sites."""
    return both(episodes=10, cells=20, width=size, steps=200)


def cells(size: int) -> str:
    """Compare two worlds with `size` cells."""
    return both(episodes=10, cells=size, width=5, steps=max(200, size // 5))


def both(*, episodes: int, cells: int, width: int, steps: int) -> str:
    """Record two worlds, save and load one, and compare them."""
    worlds = [world(range(first, first + episodes), cells, width, steps) for first in (0, 1000)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fixture.npz"
        save(fixture(worlds[0], width), path)
        stored = load(path)
        found = compare(
            stored.sample,
            worlds[1],
            alpha=0.05,
            tolerance=None,
            generator=np.random.default_rng(0),
            sensors=stored.sensors,
            permutations=200,
        )
        return f"{path.stat().st_size / 1e6:.1f} MB, {found.verdict.result}"


def recording(size: int) -> str:
    """Save and load a recording of about `size` MB.

    From the 501st on, episodes are copies of earlier ones under other seeds.
    """
    count = max(2, size * 1_000_000 // EPISODE)
    distinct = [world(range(seed, seed + 1), 400, 20, 1500) for seed in range(min(count, 500))]
    told: list[str] = []
    footprint = Footprint(count, told.append)
    parts = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fixture.npz"
        try:
            for seed in range(count):
                parts.append(copied(distinct[seed % len(distinct)], seed))
                footprint.add(parts[-1])
                if told:
                    return f"warned: {told[0]}"
            whole = merge(parts)
            del parts, distinct
            save(fixture(whole, 20), path)
            episodes = whole.episodes
            del whole
            load(path)
        except TarlError as problem:
            return f"refused: {problem}"
        return f"{path.stat().st_size / 1e6:.1f} MB of {episodes:,} episodes"


def copied(one: Sample, seed: int) -> Sample:
    """Return a copy of an episode under another seed, which shares no memory with it."""
    return replace(copy.deepcopy(one), seeds=(seed,))


def world(seeds: range, cells: int, width: int, steps: int) -> Sample:
    """Record episodes that wander through the cells and run some of the sites in each step."""
    parts = []
    for seed in seeds:
        draws = np.random.default_rng(seed)
        recorder = Recorder()
        place = int(draws.integers(cells))
        for step in range(steps):
            place = (place + int(draws.integers(-3, 4))) % cells
            recorder.latch((place,))
            for site in range(step % 5, width, max(5, width // 20)):
                recorder.hook(site, float(place))
            recorder.reward(float(draws.normal()))
        parts.append(sample(recorder.finish(), seed, True, [range(width)]))
    return merge(parts)


def fixture(whole: Sample, width: int) -> Fixture:
    """Return a sample as a recording."""
    places = tuple(
        SitePlace(f"node:run:x{n} = «{n}»", "node.py", n + 1, f"x{n} = {n}", "data", "assign")
        for n in range(width)
    )
    return Fixture(
        test="test_node.py::test_it",
        seed=0,
        sensors=(
            Sensor(
                "x", topic="/in", field="data", low=0, high=1, bins=1 + max(cell[0] for cell in whole.cells)
            ),
        ),
        lists=(TaintList("/in", "/out", places),),
        topics={"/in": "std_msgs/msg/Float64"},
        sample=whole,
        sarsa=(np.full((len(whole.cells), width), np.nan),),
    )


CASES: dict[str, tuple[Callable[[int], str], tuple[int, ...]]] = {
    "messages": (messages, (10_000, 100_000, 1_000_000)),
    "megabytes": (megabytes, (1, 10, 100)),
    "events": (events, (100_000, 1_000_000, 10_000_000)),
    "sites": (sites, (100, 1_000, 10_000)),
    "cells": (cells, (1_000, 10_000, 100_000)),
    "recording": (recording, (2, 20, 200, 2_000)),
}


def main() -> None:
    """Print a row for each case and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="*", help=f"of {', '.join(CASES)} (default: all)")
    parser.add_argument("--share", type=float, default=1.0, help="share of the largest size (default 1)")
    parser.add_argument("--size", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.size is not None:
        before = process_time(), peak()
        told = CASES[given.cases[0]][0](given.size)
        print(json.dumps([process_time() - before[0], before[1], peak(), told]))
        return
    print("| case | size | CPU s | peak MB | ms a unit | kB a unit | result |\n|---|---|---|---|---|---|---|")
    worse = []
    for name in given.cases or CASES:
        rows = []
        for size in CASES[name][1]:
            if size > max(CASES[name][1][-1] * given.share, CASES[name][1][0]):
                break
            done = subprocess.run(
                [sys.executable, __file__, name, "--size", str(size)], capture_output=True, text=True
            )
            if done.returncode:
                print(
                    f"| {name} | {size:,} | | | | | {done.stderr.strip().splitlines()[-1][:200]} |",
                    flush=True,
                )
                worse.append(name)
                break
            seconds, base, top, told = json.loads(done.stdout)
            rows.append((seconds / size * 1e3, (top - base) / size * 1e3))
            print(
                f"| {name} | {size:,} | {seconds:.2f} | {top:.0f} | {rows[-1][0]:.4g} | {rows[-1][1]:.3g} | {told} |",
                flush=True,
            )
        if len(rows) > 1 and any(
            last > WORSE * max(before, 1e-3)
            for before, last in zip(rows[min(1, len(rows) - 2)], rows[-1], strict=True)
        ):
            worse.append(name)
    if worse:
        sys.exit(f"not in proportion: {', '.join(dict.fromkeys(worse))}")


def peak() -> float:
    """Return the peak resident memory in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


if __name__ == "__main__":
    main()
