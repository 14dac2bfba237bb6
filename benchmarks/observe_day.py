"""Run a simulated day of `observe` at 100 Hz as fast as possible, to see whether memory grows or steps are lost.

`python benchmarks/observe_day.py --hours 24` runs the control cycle of observe.py on a simulated clock, one mission per
hour, with a log that is rotated by size. Every hour, it prints the resident memory of the node's process and of the
writer. Then it reads the log back: each step must occur once, in order, and each second must have all its steps. The
exit status is 1 if a step is missing, if the median memory of the day's last quarter exceeds that of the second quarter
by more than --growth MB, or if the number of memory blocks in the node's process has grown.

The simulated clock stands still while more than a second of steps waits for the observer's thread, because a robot's
clock never runs ahead of that thread. Otherwise the resident memory would show how far the clock ran ahead: the heap
keeps the size needed for the largest backlog, although its blocks are free.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import process_time, sleep

import numpy as np
from observe import SENSORS, Message, node

from pytest_tarl.instrumentation.trace import Floats
from pytest_tarl.observing import observer as observing
from pytest_tarl.observing.log_format import records, set_aside
from pytest_tarl.observing.observer import Observer
from pytest_tarl.observing.writer import Rotation, unpacked

RATE = 100  # cycles per second
BEHIND = RATE  # maximum number of steps that wait for the observer's thread
OBJECTS = 1000  # maximum growth of the number of memory blocks held by Python
SAMPLES = 24  # number of memory samples, and of missions
ABOUT = {"node": "node.py", "sites": [], "sensors": [one.name for one in SENSORS]}


class Clock:
    """A clock that the loop advances."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        """Return the time."""
        return self.now


def main() -> None:
    """Run the day and print the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=24.0, help="hours to simulate (default 24)")
    parser.add_argument(
        "--log-size", type=float, default=50.0, metavar="MB", help="size at which to rotate (default 50)"
    )
    parser.add_argument(
        "--growth", type=float, default=5.0, metavar="MB", help="allowed growth of memory (default 5)"
    )
    given = parser.parse_args()
    cycles = max(SAMPLES, round(given.hours * 3600 * RATE / SAMPLES) * SAMPLES)
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        sizes, blocks, dropped = day(log, cycles, Rotation(round(given.log_size * 1e6)))
        parts = [*set_aside(log), log]
        rewards, times = (np.concatenate(column) for column in zip(*read(parts), strict=True))
        lengths = [part.stat().st_size / 1e6 for part in parts]
    missing = cycles - len(np.unique(rewards))
    disorder = int((np.diff(rewards) != 1).sum())
    seconds = np.bincount(np.floor((np.arange(cycles) + 0.5) / RATE).astype(int)[: len(rewards)])
    late = (
        float(np.abs(times - (np.arange(len(times)) % (cycles // SAMPLES)) / RATE).max())
        if not missing
        else -1
    )
    quarter = len(sizes) // 4
    growth = np.median(sizes[-quarter:], axis=0) - np.median(sizes[quarter : 2 * quarter], axis=0)
    print(f"\n{cycles:,} steps in {len(seconds):,} s: {missing} missing, {disorder} out of order")
    print(f"{dropped} events dropped; times are off by {late * 1e3:.3f} ms at most")
    print(f"{len(parts)} files of {min(lengths):.1f} to {max(lengths):.1f} MB")
    print(f"memory, last quarter over second: node {growth[0]:+.1f} MB, writer {growth[1]:+.1f} MB")
    objects = min(blocks[-quarter:]) - min(blocks[quarter : 2 * quarter])
    print(
        f"memory blocks of the node's process, minimum of the last quarter minus that of the second: {objects:+,}"
    )
    if missing or disorder or dropped or growth.max() > given.growth or objects > OBJECTS:
        sys.exit(1)


def day(log: Path, cycles: int, rotation: Rotation) -> tuple[list[tuple[float, float]], list[int], int]:
    """Run the cycles; return samples of both processes' memory (MB) and of the blocks, and the dropped events."""
    clock, sizes, blocks = Clock(), [], list[int]()
    vars(observing)["monotonic"] = clock
    observer = Observer(SENSORS, log, ABOUT, rotation=rotation, following=True)
    cycle = node(log.parent, observer.stream)
    print(
        "| hour | node MB | writer MB | files | CPU s of the node | blocks |\n|---|---|---|---|---|---|",
        flush=True,
    )
    for number in range(cycles):
        if number % (cycles // SAMPLES) == 0:
            sizes.append((resident("self"), resident(str(observer._outlet._process.pid))))
            blocks.append(sys.getallocatedblocks())
            row = f"| {clock.now / 3600:.1f} | {sizes[-1][0]:.1f} | {sizes[-1][1]:.1f} | {len(set_aside(log)) + 1} |"
            print(f"{row} {process_time():.0f} | {blocks[-1]:,} |", flush=True)
            observer.begin()
        value = (number % 1000) / 100.0
        message = Message(value, number % 50 < 10)
        for sensor in SENSORS:
            observer.told(sensor, message)
        cycle(value)
        observer.step(float(number))
        clock.now += 1 / RATE
        while len(observer._times) > BEHIND or observer._outlet.unsent > 1 << 19:
            sleep(0.0005)  # wait for the thread and the disk, which are slower than the simulated clock
    observer.end(passed=True)
    observer.close()
    sizes.append((resident("self"), sizes[-1][1]))
    blocks.append(sys.getallocatedblocks())
    return sizes, blocks, observer.stream.dropped


def resident(process: str) -> float:
    """Return a process's resident memory in MB."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1e3 for line in lines if line.startswith("VmRSS"))


def read(parts: list[Path]) -> Iterator[tuple[Floats, Floats]]:
    """Yield the rewards and times in each record of steps."""
    for part in parts:
        for record in records(part):
            if record["kind"] == "steps":
                yield unpacked(record["reward"], "float64"), np.array(record["times"])


if __name__ == "__main__":
    main()
