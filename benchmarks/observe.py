"""Measure how much time `observe` adds to a control cycle: p50, p99 and p99.9 of a loop with and without it.

Run `python benchmarks/observe.py`. A cycle is a node's work between a message and its command: the callback and the
control law, 18 recorded lines. In each cycle, the observer receives two sensors and a reward, as on a robot, while the
log is written and synced. Blocks with and without it alternate, each in its own process. A cycle's time starts when the
cycle is due, so that it includes delays by other threads; in the row `executing`, it starts at the cycle's first line.
With `--realtime`, the loop has real-time priority (SCHED_FIFO), as control loops do, so that other programs do not
delay it.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter_ns, sleep
from typing import Any

import numpy as np

from pytest_tarl import Sensor
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.observing.observer import Observer

SENSORS = (
    Sensor("x", topic="/odom", field="x", low=0, high=10, bins=24),
    Sensor("terrain", topic="/terrain", field="data"),
)
LINES = [f"    v{n} = v{n - 1} * 0.5 + {n}" for n in range(1, 19)]
NODE = "\n".join(["def cycle(v0):", *LINES, "    speed = 5 * v18", "    return speed", ""])
PERIOD = 0.002  # seconds between two cycles
WARM = 50  # cycles at the start of a block that do not count
AT = (50, 99, 99.9)


@dataclass
class Message:
    """A message on a sensor's topic."""

    x: float = 0.0
    data: bool = False


def node(folder: Path, hooks: Any = None) -> Any:
    """Return the node's cycle, instrumented with the hooks of the stream, or plain."""
    path = folder / "node.py"
    path.write_text(NODE)
    columns = {(number, 5): number - 2 for number in range(2, 22)}
    if hooks is None:
        space: dict[str, Any] = {}
        exec(compile(NODE, str(path), "exec"), space)  # noqa: S102 (the node above)
        return space["cycle"]
    with NodeImports(folder, {path: columns}, hooks.hook, bind=hooks.bind) as imports:
        return imports.run_script(path, "observed_node").cycle


def main() -> None:
    """Print the percentiles."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=20_000, help="cycles of each kind (default 20000)")
    parser.add_argument("--blocks", type=int, default=10, help="number of blocks (default 10)")
    parser.add_argument("--realtime", action="store_true", help="use SCHED_FIFO (needs the privilege)")
    parser.add_argument("--block", choices=("bare", "observed"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    cycles = max(1, given.cycles // given.blocks)
    if given.block:
        print(json.dumps(block(cycles, observed=given.block == "observed", realtime=given.realtime)))
        return
    own = [sys.executable, __file__, "--cycles", str(cycles), "--blocks", "1"]
    own += ["--realtime"] if given.realtime else []
    found: dict[str, list[Any]] = {"bare": [], "observed": []}
    for _ in range(given.blocks):
        for kind, times in found.items():
            done = subprocess.run([*own, "--block", kind], check=True, stdout=subprocess.PIPE)
            times.append(json.loads(done.stdout))
    bytes_, dropped = (sum(one[name] for one in found["observed"]) for name in ("bytes", "dropped"))
    for which in ("due", "executing"):
        table(which, *(np.concatenate([one[which] for one in found[kind]]) for kind in found))
    print(f"\n{bytes_ / cycles / given.blocks:.0f} bytes of log a cycle, {dropped} events dropped")


def table(which: str, bare: Any, observed: Any) -> None:
    """Print the percentiles with and without the observer, and their differences."""
    print(
        f"\n{'since ' + which if which == 'due' else which:<12}{'p50':>10}{'p99':>10}{'p99.9':>10}   µs a cycle"
    )
    rows = [[np.percentile(column, at) for at in AT] for column in (bare, observed)]
    rows.append([after - before for before, after in zip(*rows, strict=True)])
    for name, row in zip(("bare", "observed", "added"), rows, strict=True):
        print(f"{name:<12}" + "".join(f"{one:>10.1f}" for one in row))


def block(cycles: int, *, observed: bool, realtime: bool) -> dict[str, Any]:
    """Run a block of cycles; return their times in µs."""
    if realtime:  # the priority that `chrt -f 10 tarl observe node.py` sets
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        observer = (
            Observer(SENSORS, log, {"node": "node.py", "sites": [], "sensors": []}) if observed else None
        )
        if observer is not None:
            observer.begin()
        cycle = node(Path(folder), None if observer is None else observer.stream)
        try:
            due, executing = loop(cycle, observer, cycles)
        finally:
            if observer is not None:
                observer.close()
        dropped = 0 if observer is None else observer.stream.dropped
        return {
            "due": due,
            "executing": executing,
            "dropped": dropped,
            "bytes": log.stat().st_size if observed else 0,
        }


def loop(cycle: Any, observer: Observer | None, cycles: int) -> tuple[list[float], list[float]]:
    """Run the control loop; return, for each cycle, the time since it was due and since it began (µs)."""
    since_due, since_begun = [], []
    due = perf_counter_ns()
    for number in range(cycles + WARM):
        value = (number % 100) / 10.0
        message = Message(value, number % 50 < 10)
        due = max(due + int(PERIOD * 1e9), perf_counter_ns())  # a late cycle must not make later cycles late
        sleep(max(0.0, (due - perf_counter_ns()) / 1e9))
        began = perf_counter_ns()
        if observer is not None:
            for sensor in SENSORS:
                observer.told(sensor, message)
        cycle(value)
        if observer is not None:
            observer.step(0.5)
        ended = perf_counter_ns()
        if number >= WARM:
            since_due.append((ended - due) / 1e3)
            since_begun.append((ended - began) / 1e3)
    return since_due, since_begun


if __name__ == "__main__":
    main()
