"""Run the tests on a real ROS beside programs that want every processor: lock-step must hold whatever the load.

`.venv-ros2/bin/python .ci/real_ros_under_load.py` runs the probe `profiles` 500 times and each file of tests/realros 50
times. Nothing is tried again: each failure is printed and counted, and the exit status is 1 where there is one.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Literal

ROOT = Path(__file__).resolve().parent.parent
SPINNING = "while True: pass"
LEAVES = (  # as in the Makefile: sockets that rospy leaves to the garbage collector
    "ignore:Exception ignored in:pytest.PytestUnraisableExceptionWarning",
    "ignore:unclosed <socket:ResourceWarning",
)


def main() -> None:
    """Run everything and print a row for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--probe", default="profiles", help="(default profiles)")
    parser.add_argument("--probes", type=int, default=500, help="runs of the probe (default 500)")
    parser.add_argument("--suites", type=int, default=50, help="runs of each file of tests (default 50)")
    parser.add_argument("--load", type=int, default=2 * (os.cpu_count() or 1), help="spinning processes")
    given = parser.parse_args()
    failures = 0
    print("| what | runs | failures | s |\n|---|---|---|---|", flush=True)
    with load(given.load):
        begun = monotonic()
        failed = probe(given.probe, given.probes)
        print(f"| probe {given.probe} | {given.probes} | {failed} | {monotonic() - begun:.0f} |", flush=True)
        failures += failed
        for suite in sorted((ROOT / "tests" / "realros").rglob("test_*.py")) if given.suites else ():
            begun = monotonic()
            runs, failed = repeated(suite, given.suites)
            shown = str(runs) if runs else "none: skipped on this ROS"
            print(f"| {suite.name} | {shown} | {failed} | {monotonic() - begun:.0f} |", flush=True)
            failures += failed
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


def probe(name: str, runs: int) -> int:
    """Ask the real ROS a probe so often in one process; return how many answers were others than those on file."""
    sys.path.insert(0, str(ROOT))
    from tests.realros.probes.running import LIBRARIES, answers, expected, installed, probes

    failed = 0
    if not any(installed(generation) for generation in LIBRARIES):
        sys.exit("no ROS is installed in this environment: make setup-ros1 setup-ros2")
    for generation in LIBRARIES:
        for path in (one for one in probes(generation) if one.stem == name and installed(generation)):
            wanted = expected(generation)[name]
            for number in range(runs):
                found = answers(path, "real")
                if found != wanted:
                    failed += 1
                    print(f"run {number}: {found} instead of {wanted}", flush=True)
    return failed


def repeated(suite: Path, times: int) -> tuple[int, int]:
    """Run a file of tests so often; return the runs in which a test ran, and those that failed."""
    failed = 0
    for made in range(times):
        outcome = ran(suite)
        if outcome == "skipped":
            return made, failed
        failed += outcome == "failed"
    return times, failed


def ran(suite: Path) -> Literal["passed", "failed", "skipped"]:
    """Run a file of tests; print what failed."""
    warnings = [part for one in LEAVES for part in ("-W", one)]
    options = ["-q", "--no-header", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *warnings, str(suite)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    lines = done.stdout.splitlines()
    if done.returncode:
        print("\n".join(line for line in lines if line.startswith(("FAILED", "ERROR", "E  "))))
        return "failed"
    return "passed" if " passed" in lines[-1] else "skipped"


if __name__ == "__main__":
    main()
