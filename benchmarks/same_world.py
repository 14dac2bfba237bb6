"""Measure how often a world appears to differ from itself when it is recorded and then compared with new seeds.

    python benchmarks/same_world.py [--comparisons 10] [--worlds shuttle …] [--committed] [--workers 2]

There are thirty worlds: the tasks of benchmarks/drift, the examples, one task of benchmarks/drift_judging, and those of
benchmarks/same_worlds. No two of them draw the same episodes. A comparison consists of a `pytest --tarl-record` and a
`pytest --tarl-online`, each with its own seeds; its result is read from the JSON that the second command writes. With
`--committed`, a world is recorded once and compared repeatedly, as in CI. Results are appended to a file (--found), and
comparisons in this file are not repeated, so a run can be interrupted and resumed.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "examples"
FOUND = HERE.parent / ".tarl-same-world.jsonl"
BATCH = 10  # number of comparisons per process
ONLINE_SEEDS = 1_000_000  # added to a comparison's number, to get seeds that no recording has
SPARED = shutil.ignore_patterns(".tarl", "__pycache__", "answer.json")


@dataclass(frozen=True)
class World:
    """A simulation test, in a folder that is copied for each run."""

    folder: Path
    test: str


def worlds() -> dict[str, World]:
    """Return all worlds by name."""
    found = {}
    for task in sorted(path.parent for path in (HERE / "drift").glob("*/test_*.py")):
        found[task.name] = World(task, next(task.glob("test_*.py")).name)
    for name, test in (
        ("line_follower", "test_line_follower.py"),
        ("quadrotor", "test_quadrotor.py"),
        ("shuttle", "test_shuttle.py::test_delivers"),
        ("shuttle_both_ways", "test_shuttle.py::test_shuttles"),
    ):
        found[name] = World(EXAMPLES / name.partition("_both")[0], test)
    putter = HERE / "drift_judging" / "carpet_putter"
    found[putter.name] = World(putter, "test_putter.py")
    text = (HERE / "same_worlds" / "test_rewards.py").read_text()
    for test in (line[4:].partition("(")[0] for line in text.splitlines() if line.startswith("def test_")):
        found[test.removeprefix("test_")] = World(HERE / "same_worlds", f"test_rewards.py::{test}")
    return found


class Undrifted:
    """A pytest plugin that removes drifts from markers, so that a comparison runs the designed world."""

    @pytest.hookimpl(tryfirst=True)
    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Remove a test's drifts before its scenarios are generated."""
        marker = metafunc.definition.get_closest_marker("tarl")
        if marker is not None and isinstance(marker.kwargs, dict):
            marker.kwargs.pop("drifts", None)


def compare_here(world: World, numbers: Sequence[int], committed: bool) -> Iterator[dict[str, Any]]:
    """Record and compare in this process; yield the result of each comparison."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / world.folder.name
        shutil.copytree(world.folder, folder, ignore=SPARED)
        os.chdir(folder)
        for place, number in enumerate(numbers):
            if not committed or place == 0:
                try:
                    ran(world, "--tarl-record", f"--tarl-seed={0 if committed else number}")
                    (_,) = (folder / ".tarl" / "utility").glob("*.npz")
                except ValueError:  # too many episodes failed, so nothing was recorded
                    print(f"{world.test}: seed {number} was not recorded.", file=sys.stderr)
                    continue
            ran(world, "--tarl-online", f"--tarl-seed={ONLINE_SEEDS + number}")
            (result,) = (folder / ".tarl" / "results").glob("*.json")
            yield {"number": number, "committed": committed, **json.loads(result.read_text())["verdict"]}


def ran(world: World, *flags: str) -> None:
    """Run pytest. Raise RuntimeError if it reaches no verdict."""
    quiet = ("-q", "-p", "no:cacheprovider", "-c", os.devnull, "--rootdir", ".")
    with Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
        status = pytest.main(["-W", "ignore", *quiet, world.test, *flags], [Undrifted()])
    if status not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        raise RuntimeError(f"{world.test} {' '.join(flags)}: pytest ended with {status!r}.")


def batches(
    chosen: Iterable[str], asked: int, committed: bool, done: set[tuple[str, bool, int]]
) -> Iterator[tuple[str, list[int]]]:
    """Yield batches of missing comparisons, taking all worlds in turn."""
    names = list(chosen)
    for first in range(0, asked, BATCH):
        for name in names:
            wanted = range(first, min(first + BATCH, asked))
            numbers = [number for number in wanted if (name, committed, number) not in done]
            if numbers:
                yield name, numbers


def compared(name: str, numbers: Sequence[int], committed: bool) -> list[dict[str, Any]]:
    """Run a batch in a separate process; if it crashes, keep the results so far."""
    command = [sys.executable, __file__, "--worlds", name, "--numbers", *map(str, numbers)]
    ended = subprocess.run(
        [*command, *(["--committed"] if committed else [])],
        env={**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_PLUGINS": "pytest_tarl.plugin"},
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode:
        print(f"{name}: {ended.stderr.strip().splitlines()[-1:]}", file=sys.stderr, flush=True)
    return [{"world": name, **json.loads(line)} for line in ended.stdout.splitlines()]


def read(path: Path) -> list[dict[str, Any]]:
    """Return the results so far."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def table(found: Sequence[dict[str, Any]], committed: bool) -> Iterator[str]:
    """Yield a Markdown table that shows how often each world appeared to differ from itself."""
    yield "| world | comparisons | drifted | degraded | smallest p_drift |\n|---|---|---|---|---|"
    chosen = [one for one in found if one["committed"] == committed]
    for name in [*dict.fromkeys(one["world"] for one in chosen), "all"]:
        own = [one for one in chosen if name in (one["world"], "all")]
        said = [sum(one["result"] == what for one in own) for what in ("drifted", "degraded")]
        yield f"| {name} | {len(own)} | {said[0]} | {said[1]} | {min(one['p_drift'] for one in own):.2g} |"


def main() -> None:
    """Run the missing comparisons and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--comparisons", type=int, default=10, help="comparisons per world")
    parser.add_argument(
        "--worlds", nargs="+", default=list(worlds()), choices=list(worlds()), metavar="WORLD"
    )
    parser.add_argument("--committed", action="store_true", help="record each world once")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--found", type=Path, default=FOUND, help="file to which results are appended")
    parser.add_argument("--numbers", nargs="+", type=int, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.numbers:
        for one in compare_here(worlds()[asked.worlds[0]], asked.numbers, asked.committed):
            print(json.dumps(one), flush=True)
        return
    done = {(one["world"], one["committed"], one["number"]) for one in read(asked.found)}
    with ThreadPoolExecutor(asked.workers) as threads, asked.found.open("a") as kept:
        jobs = [
            threads.submit(compared, name, numbers, asked.committed)
            for name, numbers in batches(asked.worlds, asked.comparisons, asked.committed, done)
        ]
        for job in as_completed(jobs):
            kept.writelines(f"{json.dumps(one)}\n" for one in job.result())
            kept.flush()
    print(*table(read(asked.found), asked.committed), sep="\n")


if __name__ == "__main__":
    main()
