"""What recording costs: nanoseconds per event over the bare program, side by side in one run.

`python benchmarks/recording.py` prints a table. Each program is executed bare, with an empty hook that could
not do less, and as the plugin instruments it, in turns, and the best turn of each counts.
"""

from __future__ import annotations

import ast
import tempfile
import textwrap
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Any

from pytest_tarl.instrumentation.codecache import CodeCache
from pytest_tarl.instrumentation.instrument import Offset, instrument
from pytest_tarl.instrumentation.nodecode import NodeCode
from pytest_tarl.instrumentation.recorder import Recorder

TURNS = 60
ROUNDS = 2_000  # some ten thousand events: an episode

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


@dataclass(frozen=True)
class Timing:
    """Best seconds of one program, bare and recorded, and how many events a run has."""

    bare: float
    hook: float
    recorded: float
    events: int

    def per_event(self, seconds: float) -> float:
        """Return nanoseconds per event over the bare program."""
        return (seconds - self.bare) / self.events * 1e9


def sites_of(tree: ast.Module) -> dict[Offset, int]:
    """Return every statement inside the functions, but for the loops that only drive the program."""
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
    code: CodeType = compile(instrument(tree, sites_of(tree), inline=inline), "<program>", "exec")
    return code


def prepared(code: CodeType, space: dict[str, Any]) -> Callable[[int], None]:
    """Execute the definitions of a program and return its `work`."""
    exec(code, space)  # noqa: S102
    work: Callable[[int], None] = space["work"]
    return work


def seconds(work: Callable[[int], None]) -> float:
    """Return the CPU seconds of one run."""
    start = time.process_time()
    work(ROUNDS)
    return time.process_time() - start


def measured(source: str) -> Timing:
    """Time a program in turns."""
    bare = prepared(compile(source, "<program>", "exec"), {})
    hooked = prepared(compiled(source, inline=False), {"__tarl__": lambda _number, value: value})
    code = compiled(source, inline=True)
    best, events = [float("inf")] * 3, 0
    for _ in range(TURNS):
        recorder, space = Recorder(), dict[str, Any]()
        recorder.bind(space)
        times = seconds(bare), seconds(hooked), seconds(prepared(code, space))
        best = [min(pair) for pair in zip(best, times, strict=True)]
        events = len(recorder.finish().site)
    return Timing(best[0], best[1], best[2], events)


def finishing() -> float:
    """Return million events a second from the buffer to a trace, cells and steps included."""
    recorder = Recorder()
    hook = recorder.hook
    for step in range(1000):
        recorder.latch((step % 40,))
        for site in range(200):
            hook(site, 0.5)
        recorder.reward(1.0, {"progress": 1.0})
    start = time.process_time()
    trace = recorder.finish()
    return len(trace.site) / (time.process_time() - start) / 1e6


def compiling(lines: int) -> tuple[float, float]:
    """Return milliseconds to compile a module of so many lines with every statement recorded: cold, cached."""
    body = textwrap.dedent(MIXED).strip("\n")
    source = "\n".join([body] * (lines // (body.count("\n") + 1)))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "node.py"
        file.write_text(source)
        tree = ast.parse(source)
        plan = {file: {(line, column + 1): number for (line, column), number in sites_of(tree).items()}}
        times = []
        for _ in range(2):
            start = time.process_time()
            NodeCode(plan, {}, (), inline=True, cache=CodeCache(Path(folder) / "cache")).compile(file)
            times.append((time.process_time() - start) * 1e3)
    return times[0], times[1]


def main() -> None:
    """Print the table."""
    print(f"{'ns per event over the bare program':42}{'empty hook':>12}{'recorded':>12}{'events':>12}")
    for name, source in (("straight-line numeric code", STRAIGHT), ("mixed code", MIXED)):
        timing = measured(source)
        hook, recorded = timing.per_event(timing.hook), timing.per_event(timing.recorded)
        print(f"{name:42}{hook:12.1f}{recorded:12.1f}{timing.events:12,}")
    print(f"\nbuffer → trace: {finishing():.1f} million events/s")
    cold, cached = compiling(1000)
    print(f"module of 1,000 lines, every statement recorded: {cold:.1f} ms cold, {cached:.1f} ms cached")


if __name__ == "__main__":
    main()
