"""Measure the cost of recording and, in the same run, that of coverage tools.

`python benchmarks/recording.py` prints the tables. Each program runs plain, with an empty hook (the least possible
overhead), as the plugin instruments it, with coverage.py's C tracer, and with slipcover (which keeps its probes,
because it would otherwise stop counting). The runs alternate, and the best of each kind counts. Times are CPU times of
the process.
"""

from __future__ import annotations

import argparse
import ast
import os
import resource
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from pathlib import Path
from statistics import median
from types import CodeType, SimpleNamespace
from typing import Any

import episodes
import pymunk
from coverage import Coverage
from slipcover import Slipcover

from pytest_tarl.instrumentation.codecache import CodeCache
from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.instrument import Offset, instrument
from pytest_tarl.instrumentation.instrument import compiled as code_of
from pytest_tarl.instrumentation.nodecode import NodeCode
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.learning.statistics import sample

os.environ["COVERAGE_CORE"] = "ctrace"  # newer Python versions would use sys.monitoring
TURNS = 60
ROUNDS = 2_000  # rounds, which record about ten thousand events, as an episode does
STEPS = 200
DISCS = 340  # number of discs for which a step takes about 200 µs
RUNS = 12
STARTS = 41  # starts of pytest, with and without the plugin

STRAIGHT = """
def work(rounds):
    x, v, k = 0.0, 1.5, 0.3
    for _ in range(rounds):
        err = 4.0 - x
        delta = k * err
        vel = 5.0 * delta
        drag = vel * 0.1
        acc = vel - drag
        v = v * 0.9 + acc * 0.01
        x = x * 0.99 + v * 0.02
        eta = err * 0.5
"""
MIXED = """
class Twist:
    __slots__ = ("x", "z")
def limit(value, top):
    if value > top:
        return top
    return value
class Node:
    def __init__(self):
        self.kp, self.cmd, self.pos, self.count = 0.4, Twist(), 0.0, 0
    def step(self, data):
        self.pos = data * 0.5
        err = limit(4.0 - self.pos, 2.0)
        if abs(err) > 0.1 and self.count >= 0:
            self.cmd.x = self.kp * err
        else:
            self.cmd.x = 0.0
        self.cmd.z = -err
        self.count += 1
        ready = err < 1.0
        return self.cmd.x
def work(rounds):
    node = Node()
    for i in range(rounds):
        node.step(i * 0.001)
"""
LOADING = ("for _ in range(rounds)", "for i in range(rounds)", "node.step(")


def sites_of(tree: ast.Module) -> dict[Offset, int]:
    """Return all statements inside functions, except the loops that only drive the program."""
    sites: dict[Offset, int] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.name != "__init__":
            for inner in ast.walk(node):
                if (
                    isinstance(inner, ast.stmt)
                    and inner is not node
                    and not ast.unparse(inner).startswith(LOADING)
                ):
                    sites.setdefault((inner.lineno, inner.col_offset), len(sites))
    return sites


def compiled(source: str, *, inline: bool) -> CodeType:
    """Compile a program with its sites recorded."""
    tree = ast.parse(source)
    return code_of(instrument(tree, sites_of(tree), inline=inline), "<program>")


def prepared(code: CodeType, space: dict[str, Any], name: str = "work") -> Callable[..., Any]:
    """Execute a program's definitions and return its `work`, or another function."""
    exec(code, space)  # noqa: S102
    work: Callable[..., Any] = space[name]
    return work


def seconds(work: Callable[[int], None]) -> float:
    """Return the CPU seconds of one run."""
    start = time.process_time()
    work(ROUNDS)
    return time.process_time() - start


def measured(source: str) -> tuple[dict[str, float], int]:
    """Return a program's best seconds for each way of running it, and its number of events per run."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "program.py"
        file.write_text(source)
        ways = {"bare": bare, "an empty hook": hooked, "coverage.py": traced, "slipcover": covered}
        best, events = dict.fromkeys([*ways, "recorded"], float("inf")), 0
        for _ in range(TURNS):
            for name, run in ways.items():
                best[name] = min(best[name], run(source, file))
            spent, events = recorded(source)
            best["recorded"] = min(best["recorded"], spent)
    return best, events


def bare(source: str, file: Path) -> float:
    """Time an uninstrumented program."""
    return seconds(prepared(compile(source, str(file), "exec"), {}))


def hooked(source: str, _file: Path) -> float:
    """Time a program whose hook does nothing."""
    return seconds(prepared(bound(compiled(source, inline=False), lambda _number, value: value), {}))


def recorded(source: str) -> tuple[float, int]:
    """Time a program as the plugin runs it, and count its events."""
    recorder = Recorder()
    spent = seconds(prepared(recorder.bind(compiled(source, inline=True)), {}))
    return spent, len(recorder.finish().site)


def traced(source: str, file: Path) -> float:
    """Time a program with coverage.py's C tracer, lines only."""
    coverage = Coverage(data_file=None, config_file=False, include=[str(file)])
    work = prepared(compile(source, str(file), "exec"), {})
    coverage.start()
    try:
        return seconds(work)
    finally:
        coverage.stop()


def covered(source: str, file: Path) -> float:
    """Time a program with slipcover, lines only."""
    counter = Slipcover(d_miss_threshold=-1, source=[str(file.parent)])
    space: dict[str, Any] = {}
    return seconds(prepared(counter.instrument(compile(source, str(file), "exec")), space))


def control_step() -> tuple[float, float]:
    """Return the microseconds per step of a pymunk world with a controller of 20 sites: plain, and recorded."""
    sites = "\n".join(f"    v{i} = {'x' if i % 2 else 'node.kp'} * {i + 0.5}" for i in range(20))
    source = f"def control(node, x):\n{sites}\n    return v19\n"
    plain = prepared(compile(source, "<program>", "exec"), {}, "control")
    step, best = float("inf"), [float("inf")] * 2
    for _ in range(TURNS):
        recorder = Recorder()
        watched = prepared(recorder.bind(compiled(source, inline=True)), {}, "control")
        step = min(step, stepped(plain))
        best = [min(pair) for pair in zip(best, (called(plain), called(watched)), strict=True)]
        assert len(recorder.finish().site) >= 20 * STEPS
    return step, step + best[1] - best[0]


def called(control: Callable[[Any, float], float]) -> float:
    """Return the microseconds per call of the controller alone, which the noise of world steps would hide."""
    node = SimpleNamespace(kp=0.4)
    start = time.process_time()
    for i in range(STEPS):
        control(node, i * 0.001)
    return (time.process_time() - start) / STEPS * 1e6


def stepped(control: Callable[[Any, float], float]) -> float:
    """Return the microseconds per step of a world of discs in a box, with one call of the controller."""
    world = pymunk.Space()
    world.gravity = (0.0, -9.8)
    world.add(pymunk.Segment(world.static_body, (0, 0), (40, 0), 0.5))
    for i in range(DISCS):
        disc = pymunk.Body(1.0, 1.0)
        disc.position = (1.0 + i % 20 * 1.9, 1.5 + i // 20 * 1.9)
        world.add(disc, pymunk.Circle(disc, 1.0))
    node = SimpleNamespace(kp=0.4)
    start = time.process_time()
    for i in range(STEPS):
        control(node, i * 0.001)
        world.step(0.01)
    return (time.process_time() - start) / STEPS * 1e6


def finishing() -> tuple[float, float]:
    """Return how many million events per second are converted from buffer to trace, and to statistics."""
    best = [float("inf")] * 2
    for _ in range(10):
        recorder = Recorder()
        for step in range(1000):
            recorder.latch((step % 40,))
            for site in range(200):
                recorder.hook(site % 20, 0.5)
            recorder.reward(1.0, {"progress": 1.0})
        start = time.process_time()
        trace = recorder.finish()
        between = time.process_time()
        sample(trace, 1, True, [tuple(range(20))])
        spent = between - start, time.process_time() - start
        best = [min(pair) for pair in zip(best, spent, strict=True)]
    return len(trace.site) / best[0] / 1e6, len(trace.site) / best[1] / 1e6


def importing(source: str, sites: int) -> tuple[float, float, float]:
    """Return the milliseconds to load the code of a module with `sites` sites: cold, cached, from Python's cache."""
    sys.dont_write_bytecode = False
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "node.py"
        file.write_text(source)
        found = sites_of(ast.parse(source))
        some = list(found.items())[:: max(1, len(found) // sites)]
        plan = {file: {(line, column + 1): number for (line, column), number in some}}
        times = []
        for turn in range(10):
            cache = CodeCache(Path(folder) / "cache" / (str(turn) if turn < 5 else "4"))
            start = time.process_time()
            NodeCode(plan, {}, (), inline=True, cache=cache).compile(file)
            times.append((time.process_time() - start) * 1e3)
        own = []
        for _ in range(6):
            start = time.process_time()
            SourceFileLoader("node", str(file)).get_code("node")
            own.append((time.process_time() - start) * 1e3)
    return min(times[:5]), min(times[5:]), min(own[1:])


def starting() -> tuple[float, float]:
    """Return the CPU milliseconds of a pytest run of one empty test, without and with our plugin.

    No other plugins are active.

    Both are medians of alternating runs, because single runs differ by more than the plugin's cost.
    """
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "test_it.py").write_text("def test_it(): pass\n")
        alone = {**os.environ, "PYTHONDONTWRITEBYTECODE": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        spent: tuple[list[float], list[float]] = ([], [])
        for _ in range(STARTS):
            for times, flags in zip(spent, ((), ("-p", "pytest_tarl.plugin")), strict=True):
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                command = [
                    sys.executable,
                    "-m",
                    "pytest",
                    "-q",
                    "-p",
                    "no:cacheprovider",
                    *flags,
                    "test_it.py",
                ]
                subprocess.run(command, cwd=folder, env=alone, check=True, capture_output=True)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                times.append((after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime) * 1e3)
    # the first run of each variant writes bytecode, so it does not count
    return median(spent[0][1:]), median(spent[1][1:])


def main() -> None:
    """Print the tables."""
    global TURNS, RUNS, STARTS
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="run everything once, to test the script; the figures are not meaningful",
    )
    if parser.parse_args().quick:
        TURNS, RUNS, STARTS = 1, 1, 2  # two starts, because the first does not count
    names = ("recorded", "an empty hook", "coverage.py", "slipcover")
    print(f"| ns per event over the bare program | {' | '.join(names)} | goal | events |")
    print("|---|---|---|---|---|---|---|")
    for what, source, goal in (("straight-line numeric", STRAIGHT, 20), ("mixed", MIXED, 45)):
        best, events = measured(source)
        cells = " | ".join(f"{(best[name] - best['bare']) / events * 1e9:.1f}" for name in names)
        print(f"| {what} | {cells} | ≤ {goal} | {events:,} |")
    print("\n| what | measured | goal |\n|---|---|---|")
    bare_step, recorded_step = control_step()
    over = recorded_step / bare_step - 1
    print(f"| 20 sites in a step of a pymunk world of {bare_step:.0f} µs | {over:+.2%} | ≤ 1 % |")
    body = textwrap.dedent(MIXED).strip("\n")
    for lines, sites in ((200, 20), (1000, 20), (1000, 1000)):
        cold, cached, own = importing("\n".join([body] * (lines // (body.count("\n") + 1))), sites)
        what = "every statement" if sites == lines else f"{sites} sites"
        print(
            f"| code of a module of {lines:,} lines, {what}: cached ({cold:.1f} ms cold) | {cached:.2f} ms "
            f"(Python's own cache {own:.2f}) | ≤ 2 ms |"
        )
    off, on = starting()
    print(f"| pytest without flags, plugin on over plugin off ({off:.0f} ms) | {on - off:+.1f} ms | ≤ 5 ms |")
    to_trace, to_statistics = finishing()
    print(f"| buffer → trace | {to_trace:.1f} million events/s | |")
    print(f"| buffer → statistics | {to_statistics:.1f} million events/s | ≥ 10 |")
    print("\n" + "\n".join(episodes.table()))


if __name__ == "__main__":
    main()
