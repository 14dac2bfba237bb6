"""Time that `observe` adds to a control cycle: p50, p99, p99.9 of cycles with and without it, alternating in one run.

Run `python benchmarks/observe.py`. A cycle is what a Figure 1 style node does between a message and its command: the
callback, the control law, 18 recorded lines; the observer is told two sensors and a reward in each, as on a robot,
while its thread writes and syncs the log.
"""

from __future__ import annotations

import argparse
import gc
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter_ns, sleep
from typing import Any

import numpy as np

from pytest_tarl import Sensor
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.observing.frames import LogFile
from pytest_tarl.observing.observer import Observer

SENSORS = (
    Sensor("x", topic="/odom", field="x", low=0, high=10, bins=24),
    Sensor("terrain", topic="/terrain", field="data"),
)
LINES = [f"    v{n} = v{n - 1} * 0.5 + {n}" for n in range(1, 19)]
NODE = "\n".join(["def cycle(v0):", *LINES, "    speed = 5 * v18", "    return speed", ""])
PERIOD = 0.002  # seconds between two cycles


@dataclass
class Message:
    """What a sensor's topic carries."""

    x: float = 0.0
    data: bool = False


def node(folder: Path, hooks: Any = None) -> Any:
    """Return the node's cycle, instrumented with the stream's hooks or as it is."""
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
    parser.add_argument("--cycles", type=int, default=5000, help="of each kind (default 5000)")
    cycles = parser.parse_args().cycles
    with ExitStack() as open_:
        folder = Path(open_.enter_context(tempfile.TemporaryDirectory()))
        observer = Observer(SENSORS, LogFile(folder / "log"), {"node": "node.py", "sites": [], "sensors": []})
        open_.callback(observer.close)
        observer.begin()
        plain, observed = node(folder), node(folder, observer.stream)
        times = np.array([_pair(plain, observed, observer, n) for n in range(cycles)]) / 1000.0
        gc.collect()
        log = folder / "log"
        print(f"{'':<12}{'p50':>10}{'p99':>10}{'p99.9':>10}   µs a cycle")
        for name, column in (("bare", times[:, 0]), ("observed", times[:, 1])):
            _row(name, column)
        _row("added", np.sort(times[:, 1]) - np.sort(times[:, 0]))
        print(
            f"{log.stat().st_size / cycles:.0f} bytes of log a cycle, {observer.stream.dropped} events dropped"
        )


def _pair(plain: Any, observed: Any, observer: Observer, number: int) -> tuple[int, int]:
    sleep(PERIOD)
    value = (number % 100) / 10.0
    message = Message(value, number % 50 < 10)
    began = perf_counter_ns()
    plain(value)
    middle = perf_counter_ns()
    for sensor in SENSORS:
        observer.told(sensor, message)
    observed(value)
    observer.step(0.5)
    return middle - began, perf_counter_ns() - middle


def _row(name: str, column: Any) -> None:
    print(f"{name:<12}" + "".join(f"{np.percentile(column, at):>10.1f}" for at in (50, 99, 99.9)))


if __name__ == "__main__":
    main()
