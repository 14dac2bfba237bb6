"""Measure `tarl watch`: false alarms over long streams, missions until a drift is detected, and cost.

    python benchmarks/watch.py alarms [--streams 2000]     # no drift, a new recording for each stream
    python benchmarks/watch.py delays [--streams 20]       # a drift that begins at mission 0, 1,000 and 100,000
    python benchmarks/watch.py speed [--missions 1000000]  # the command on a log, CPU time and memory

Two common methods run for comparison. One is a two-sample Kolmogorov-Smirnov test at 5 % of the last 40 missions'
totals against the recorded ones, repeated every ten missions. The other is a two-sided CUSUM of the totals (k = 0.5, h
= 5), standardised by the recorded missions' mean and standard deviation.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
from gate_worlds import WORLDS
from watch_streams import WATCHED, fixture, pools, stream, total_range

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.fixture import Fixture, save
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Floats, Sample
from pytest_tarl.monitoring.monitor import Monitor, begun
from pytest_tarl.observing.log_format import MAGIC, encoded
from pytest_tarl.observing.stream import Chunk
from pytest_tarl.observing.writer import steps_record
from pytest_tarl.seeds import episode_seed, generator
from pytest_tarl.sensors import Sensor

ALPHA = 0.05
LIFE = 1000  # missions in a stream without drift, and maximum number after a drift starts
SIZES = (0.2, 0.5, 1.0)
STARTS = (0, 1000, 100_000)
DISTINCT = 5000  # distinct missions in the log of the speed test
WINDOW, EVERY = 40, 10
METHODS = ("watch", "success", "mean", "world", "repeated KS", "CUSUM")


@dataclass(frozen=True)
class Alarms:
    """The mission (from 1) at which each method first raised an alarm; None if it never did."""

    first: dict[str, int | None]

    def after(self, method: str, start: int) -> int | None:
        """Return the missions from a drift's start to the first alarm; None if that came earlier or never."""
        found = self.first[method]
        return found - start if found is not None and found > start else None


def watched(monitor: Monitor, missions: Sample, until: bool) -> None:
    """Pass missions to a monitor; with `until`, in portions, stopping at the first alarm."""
    if not until:
        monitor.take(missions, np.zeros(missions.episodes))
        return
    chain = missions.chain
    for begin in range(0, missions.episodes, 50):
        rows = (chain.episode >= begin) & (chain.episode < begin + 50)
        columns = {name: column[rows] for name, column in vars(chain).items()}
        part = slice(begin, begin + 50)
        some = Sample(
            missions.cells,
            missions.seeds[part],
            missions.passed[part],
            missions.total[part],
            missions.steps[part],
            missions.part_names,
            type(chain)(**columns | {"episode": columns["episode"] - begin}),
            (),
        )
        monitor.take(some, np.zeros(some.episodes))
        bounds, world = np.split(monitor.processes.alarm >= 0, [len(monitor.bounds)])
        if bounds.all() and world.any():
            return


def alarms(monitor: Monitor, offline: Floats, online: Floats) -> Alarms:
    """Return each method's first alarm; `online` has the totals of all missions."""
    raised = monitor.processes.alarm
    stated = {bound.what: raised[row : row + 1] for row, bound in enumerate(monitor.bounds)}
    nothing = raised[:0]
    success, mean = (_first(stated.get(what, nothing)) for what in ("success", "total"))
    world = _first(raised[len(monitor.bounds) :])
    return Alarms(
        {
            "watch": _first(raised),
            "success": success,
            "mean": mean,
            "world": world,
            "repeated KS": repeated(offline, online),
            "CUSUM": cusum(offline, online),
        }
    )


def _first(raised: np.ndarray[tuple[int], np.dtype[np.int64]]) -> int | None:
    found = raised[raised >= 0]
    return int(found.min()) + 1 if found.size else None


def repeated(offline: Floats, online: Floats) -> int | None:
    """Return the mission at which the test of the last missions is first significant at 5 %."""
    reference = np.sort(offline)
    n, m = len(offline), WINDOW
    critical = 1.3581 * np.sqrt((n + m) / (n * m))
    for end in range(WINDOW, len(online) + 1, EVERY):
        window = np.sort(online[end - WINDOW : end])
        everything = np.concatenate((reference, window))
        mine = np.searchsorted(reference, everything, side="right") / n
        theirs = np.searchsorted(window, everything, side="right") / m
        if np.abs(mine - theirs).max() > critical:
            return end
    return None


def cusum(offline: Floats, online: Floats) -> int | None:
    """Return the mission at which a CUSUM with k = 0.5 and h = 5 standard deviations first raises an alarm."""
    deviation = float(offline.std()) or 1.0
    low = high = 0.0
    for number, value in enumerate(((online - offline.mean()) / deviation).tolist(), 1):
        low, high = max(0.0, low - value - 0.5), max(0.0, high + value - 0.5)
        if max(low, high) > 5.0:
            return number
    return None


def false_alarms(streams: int, worlds: Sequence[str]) -> None:
    """Print how often each method raises an alarm without a drift."""
    print(
        f"{streams} streams of {LIFE} missions without drift, each with a new recording; share with any alarm"
    )
    print("| world | streams | " + " | ".join(METHODS) + " |")
    print("|---|" + "---|" * (len(METHODS) + 1))
    total: list[Alarms] = []
    each = -(-streams // len(worlds))
    for world in worlds:
        found = []
        for number in range(min(each, streams - len(total))):
            rng = generator(number, f"watch/alarms/{world}")
            designed = pools(world, 0.0).designed
            recorded = fixture(designed, rng, total_range(world))
            monitor = begun(recorded, alpha=ALPHA, seed=number)
            online = stream(designed, recorded.sample.cells, LIFE, rng)
            watched(monitor, online, until=False)
            found.append(alarms(monitor, recorded.sample.total, online.total))
        total += found
        print(_row(world, found), flush=True)
    print(_row("all", total))
    share = sum(one.first["watch"] is not None for one in total) / len(total)
    error = (ALPHA * (1 - ALPHA) / len(total)) ** 0.5
    print(f"watch {share:.4f}, alpha {ALPHA}, binomial error of alpha {error:.4f}")


def _row(name: str, found: list[Alarms]) -> str:
    shares = [sum(one.first[method] is not None for one in found) / len(found) for method in METHODS]
    return f"| {name} | {len(found)} | " + " | ".join(f"{100 * share:.1f} %" for share in shares) + " |"


def delays(streams: int, long: int) -> None:
    """Print the missions until each method detects a drift; `long` is the number of streams with the latest start."""
    print(
        "| drift begins at | size | streams | method | before it | noticed | median missions until | 90 % within |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for start in STARTS:
        found: dict[float, list[Alarms]] = {size: [] for size in SIZES}
        for world in WORLDS:
            for number in range(long if start > 10_000 else streams):
                for size, one in _drifts(world, number, start).items():
                    found[size].append(one)
        for size in SIZES:
            for method in METHODS:
                print(_delays(start, size, method, found[size]), flush=True)


def _drifts(world: str, number: int, start: int) -> dict[float, Alarms]:
    """Return all methods' alarms for each size of a drift, after the same missions without drift."""
    rng = generator(number, f"watch/delays/{world}/{start}")
    designed = pools(world, 0.0).designed
    recorded = fixture(designed, rng, total_range(world))
    quiet = begun(recorded, alpha=ALPHA, seed=number)
    before: list[Floats] = [np.empty(0)]
    for begin in range(0, start, LIFE):
        missions = stream(designed, recorded.sample.cells, min(LIFE, start - begin), rng)
        watched(quiet, missions, until=False)
        before.append(missions.total)
    found = {}
    for size in SIZES:
        monitor = deepcopy(quiet)
        missions = stream(pools(world, size).drifting, recorded.sample.cells, LIFE, rng)
        watched(monitor, missions, until=True)
        found[size] = alarms(monitor, recorded.sample.total, np.concatenate((*before, missions.total)))
    return found


def _delays(start: int, size: float, method: str, found: list[Alarms]) -> str:
    early = sum(1 for one in found if (at := one.first[method]) is not None and at <= start)
    after = sorted(gap for one in found if (gap := one.after(method, start)) is not None)
    count = len(found) - early
    padded = [*map(float, after), *([float("inf")] * (count - len(after)))]
    middle = median(padded) if padded else float("nan")
    ninth = padded[min(len(padded) - 1, int(0.9 * len(padded)))] if padded else float("nan")
    return (
        f"| {start:,} | {size:g} | {len(found)} | {method} | {early} | {len(after)} of {count} | {_told(middle)} | "
        f"{_told(ninth)} |"
    )


def _told(count: float) -> str:
    return "–" if np.isnan(count) else f"> {LIFE:,}" if np.isinf(count) else f"{count:,.0f}"


def speed(missions: int) -> None:
    """Print what the command costs on a log of missions with ten steps over 24 places."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        size = _logged(folder, missions)
        command = [sys.executable, "-m", "pytest_tarl", "watch", "m.log", "--fixture", "f.npz", "--once"]
        before = _loop()
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        state = next((folder / ".tarl/watch").glob("*.npz")).stat().st_size
    print(done.stdout or done.stderr)
    print(
        f"{missions:,} missions, {size / 1e6:.0f} MB of log: {used.ru_utime + used.ru_stime:.1f} s of CPU "
        f"({used.ru_utime:.1f} user), {used.ru_maxrss / 1024:.0f} MB, state {state / 1000:.0f} kB; ten million "
        f"additions in a loop took {before:.2f} s before and {_loop():.2f} s after it"
    )


def _loop() -> float:
    """Return the CPU seconds of a plain loop, which measures the machine's current speed."""
    begin = process_time()
    total = 0
    for number in range(10_000_000):
        total += number
    return process_time() - begin


def _logged(folder: Path, missions: int) -> int:
    rng = generator(0, "watch/speed")
    sensors = (Sensor("x", topic="/x", field="data", low=0, high=24, bins=24),)
    cells = [[place] for place in range(24)]

    def drawn(count: int) -> tuple[list[np.ndarray[tuple[int], np.dtype[np.int32]]], Floats]:
        begin = rng.integers(0, 15, count)
        return [np.arange(one, one + 10, dtype=np.int32) for one in begin.tolist()], rng.normal(
            1.0, 0.3, (count, 10)
        )

    samples = []
    for number, (places, reward) in enumerate(zip(*drawn(200), strict=True)):
        empty = np.empty(0, np.int32)
        trace = Trace(
            tuple((one,) for one in range(24)), empty, np.empty(0), empty, empty, places, reward, {}
        )
        samples.append(sample(trace, episode_seed(0, "speed", number), True, ()))
    save(Fixture("speed", 0, sensors, (), {}, merge(samples), ()), folder / "f.npz")
    head = {"kind": "start", "format": 1, "time": 0.0, "test": "speed", "sensors": ["x"], "sites": []}
    some = [encoded(_steps(cells, places, reward)) for places, reward in zip(*drawn(DISTINCT), strict=True)]
    with (folder / "m.log").open("wb") as file:
        file.write(MAGIC + encoded(head))
        for second in range(0, missions, 1000):
            begin = encoded({"kind": "mission", "time": float(second)})
            end = encoded({"kind": "end", "passed": True, "failure": "", "time": second + 0.5})
            for which in rng.integers(DISTINCT, size=min(1000, missions - second)).tolist():
                file.write(begin + some[which] + end)
        return file.tell()


def _steps(
    cells: list[list[int]], places: np.ndarray[tuple[int], np.dtype[np.int32]], reward: Floats
) -> dict[str, object]:
    """Return the record that `observe` writes for a node without recorded sites."""
    none, nothing = np.empty(0, np.int32), np.empty(0)
    chunk = Chunk(tuple(map(tuple, cells)), none, nothing, none, none, none, places, reward)
    return steps_record(chunk, [], 0)


def main() -> None:
    """Print the requested tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=("alarms", "delays", "speed"))
    parser.add_argument(
        "--streams",
        type=int,
        help="streams in total (alarms, default 2000) or per world (delays, default 20)",
    )
    parser.add_argument(
        "--long",
        type=int,
        default=2,
        help="streams per world with 100,000 missions before the drift (default 2)",
    )
    parser.add_argument(
        "--worlds", nargs="+", choices=WATCHED, default=WATCHED, help="worlds for the false alarms"
    )
    parser.add_argument("--missions", type=int, default=10**6)
    asked = parser.parse_args()
    if asked.part == "alarms":
        false_alarms(asked.streams or 2000, asked.worlds)
    elif asked.part == "delays":
        delays(asked.streams or 20, asked.long)
    else:
        speed(asked.missions)


if __name__ == "__main__":
    main()
