"""Run the tests on a real ROS while other programs keep every processor busy: lock-step must hold under any load.

`.venv-ros2/bin/python .ci/real_ros_under_load.py` runs the probe `profiles` 500 times and each file of tests/realros 50
times. The files run in rounds, so that each has run equally often if the script is stopped early (`--minutes`, Ctrl-C).
A failed test is not repeated. Each failure is printed and counted, and with `--keep` its whole output is stored. The
exit status is 1 if there is a failure.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf
from pathlib import Path
from time import monotonic
from typing import Literal

ROOT = Path(__file__).resolve().parent.parent
SPINNING = "while True: pass"
LEAVES = (  # as in the Makefile: sockets that rospy leaves to the garbage collector
    "ignore:Exception ignored in:pytest.PytestUnraisableExceptionWarning",
    "ignore:unclosed <socket:ResourceWarning",
)


@dataclass
class Count:
    """How often a file of tests ran and failed, and the seconds that this took."""

    runs: int = 0
    failures: int = 0
    seconds: float = 0.0
    skipped: bool = False  # whether all tests of the file were skipped, because they are for another ROS

    def row(self, name: str) -> str:
        """Return the row of the table."""
        runs = "none: skipped on this ROS" if self.skipped else str(self.runs)
        return f"| {name} | {runs} | {self.failures} | {self.seconds:.0f} |"


def main() -> None:
    """Run the probe and the files of tests, and print a row for each of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--probe", default="profiles", help="(default profiles)")
    parser.add_argument("--probes", type=int, default=500, help="runs of the probe (default 500)")
    parser.add_argument("--suites", type=int, default=50, help="runs of each file of tests (default 50)")
    parser.add_argument("--only", nargs="*", default=[], metavar="FILE", help="only files with these names")
    parser.add_argument(
        "--minutes", type=float, default=inf, help="minutes after which no further run of a file begins"
    )
    parser.add_argument("--keep", type=Path, help="folder for the output of each run that failed")
    parser.add_argument(
        "--load",
        type=int,
        default=2 * (os.cpu_count() or 1),
        help="number of processes that keep the processors busy",
    )
    given = parser.parse_args()
    end = monotonic() + 60 * given.minutes
    files = sorted((ROOT / "tests" / "realros").rglob("test_*.py"))
    if unknown := sorted({*given.only} - {path.name for path in files}):
        parser.error(f"{unknown[0]}: not a file of tests/realros")
    with load(given.load):
        begun = monotonic()
        runs, failures = probe(given.probe, given.probes)
        seconds = monotonic() - begun
        suites = [path for path in files if not given.only or path.name in given.only]
        counts = in_rounds(suites, given.suites, end, given.keep)
    print("| what | runs | failures | s |\n|---|---|---|---|")
    shown = str(runs) if runs or not given.probes else "none: there is no such probe for this ROS"
    print(f"| probe {given.probe} | {shown} | {failures} | {seconds:.0f} |")
    for path, count in counts.items():
        print(count.row(path.name))
        failures += count.failures
    sys.exit(bool(failures))


@contextmanager
def load(processes: int) -> Iterator[None]:
    """Keep the processors busy."""
    spinning = [subprocess.Popen([sys.executable, "-c", SPINNING]) for _ in range(processes)]
    try:
        yield
    finally:
        for one in spinning:
            one.kill()
            one.wait()


def probe(name: str, times: int) -> tuple[int, int]:
    """Run a probe `times` times on the real ROS in one process; return the numbers of runs and of wrong answers."""
    sys.path.insert(0, str(ROOT))
    from tests.realros.probes.running import LIBRARIES, answers, expected, installed, probes

    runs = failed = 0
    if not any(installed(generation) for generation in LIBRARIES):
        sys.exit("no ROS is installed in this environment: make setup-ros1 setup-ros2")
    for generation in LIBRARIES:
        for path in (one for one in probes(generation) if one.stem == name and installed(generation)):
            wanted = expected(generation)[name]
            for number in range(times):
                found = answers(path, "real")
                runs += 1
                if found != wanted:
                    failed += 1
                    print(f"run {number}: {found} instead of {wanted}", flush=True)
    return runs, failed


def in_rounds(suites: list[Path], rounds: int, end: float, keep: Path | None) -> dict[Path, Count]:
    """Run each file once in each round; leave out the files whose tests are all skipped on this ROS."""
    counts = {suite: Count() for suite in suites}
    remaining = list(suites)
    try:
        for number in range(rounds):
            for suite in list(remaining):
                if monotonic() > end:
                    return counts
                begun = monotonic()
                outcome, output = ran(suite)
                seconds = monotonic() - begun
                print(f"round {number}, {suite.name}: {outcome} in {seconds:.0f} s", flush=True)
                if outcome == "skipped":
                    remaining.remove(suite)
                    counts[suite].skipped = True
                    continue
                counts[suite].runs += 1
                counts[suite].seconds += seconds
                if outcome == "failed":
                    counts[suite].failures += 1
                    told(suite, number, output, keep)
    except KeyboardInterrupt:
        print("stopped: these are the runs so far", flush=True)
    return counts


def told(suite: Path, number: int, output: str, keep: Path | None) -> None:
    """Print what failed in a run, and store its whole output."""
    important = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR", "E  "))]
    print("\n".join(important), flush=True)
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        (keep / f"{suite.stem}-{number}.txt").write_text(output, encoding="utf-8")


def ran(suite: Path) -> tuple[Literal["passed", "failed", "skipped"], str]:
    """Run a file of tests; return the outcome and the output."""
    warnings = [part for one in LEAVES for part in ("-W", one)]
    options = ["-q", "--no-header", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *warnings, str(suite)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    lines = done.stdout.splitlines()
    if done.returncode or not lines:
        return "failed", done.stdout + done.stderr
    return ("passed" if " passed" in lines[-1] else "skipped"), done.stdout


if __name__ == "__main__":
    main()
