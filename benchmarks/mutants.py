"""Mutation testing: insert small faults, chosen by a seed, and run the tests that reach the line.

`make mutants` inserts ten faults into each package of pytest_tarl; `make mutants OF=tarl_lint` does the same for
tarl_lint. Coverage contexts record which tests reach which line, including processes that tests start. Each fault goes
into a copy of the checkout without TARL's caches. It is caught if a test fails, or if the tests take far longer than
without it. A test that also fails without the fault does not count, and a fault that no test reaches is not caught.

Tests in the file named after the module run first, then the others. Each group runs from fast to slow, until the next
test would exceed `--budget`. A slower test might still catch a surviving fault, so the share of caught faults is a
lower bound. Tests with their own pytest.ini run in a separate pytest. The script prints the share of caught faults with
its exact 95 % interval, by package and in total, and the surviving faults.

With `--forks`, a run takes only a small part of this time. One pytest imports everything and collects all tests; each
fault is put into the functions of a fork of it (`forked_tests.py`). A fault in a line that runs during imports is tried
in a fresh process instead. The lines of each test are measured with marks instead of coverage (`reach_marks.py`). A
test that takes more than `--slowest` CPU seconds is left out. Once a file's tests have taken 2.5 times as many, the
rest of the file is left out as well. Tests with their own pytest.ini do not run.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from forked_tests import IMPORTED, SLOWEST, UNCHANGED, Forks, forks
from measured_reach import known, measured, measured_in_forks
from nearest_tests import Nearest
from reached_lines import Reached
from scipy.stats import beta
from sown_faults import Fault, faults
from tested_copy import apart, collected, environment, precompiled, without_caches
from warm_pytest import Runner, warm

ROOT = Path(__file__).resolve().parent.parent
EQUIVALENT = Path(__file__).with_name("equivalent_mutants.json")
ELSEWHERE = {"realros"}  # folders of tests that need a real ROS: make test-ros1, make test-ros2
LEFT_OUT = (".git", ".venv*", "__pycache__", ".tarl", ".hypothesis", ".*_cache", "*.egg-info", ".coverage*")
# maximum CPU seconds (measured without the fault) of the tests that run for one fault
BUDGET = 120.0
PATIENCE = 120.0  # seconds allowed in addition to three times the tests' CPU time without the fault
SLOWED = 10  # a fork may take this many times its tests' CPU seconds (in wall time, on a busy machine)


@dataclass(frozen=True)
class Outcome:
    """The result of a fault: caught, survived, timeout, unreached, or unclear if tests fail without it."""

    fault: Fault
    word: str
    tests: int
    failed: str = ""  # the test that failed with the fault, if known


def main() -> None:
    """Insert the faults and print the results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--of",
        "--package",
        dest="package",
        default="pytest_tarl",
        help="package to test (default pytest_tarl)",
    )
    parser.add_argument("--only", nargs="*", default=[], metavar="PACKAGE", help="only these subpackages")
    parser.add_argument("--each", type=int, default=10, help="faults in each of its packages (default 10)")
    parser.add_argument("--count", type=int, help="faults anywhere in the package, instead of --each")
    parser.add_argument("--seed", type=int, default=0, help="chooses the faults (default 0)")
    parser.add_argument("--tests", nargs="*", default=["tests"], help="tests to run (default: all)")
    parser.add_argument(
        "--without-coverage",
        action="store_true",
        help="run all tests of the files named by --tests for each fault, instead of those that reach its line",
    )
    parser.add_argument(
        "--nearest",
        type=int,
        metavar="N",
        help="run the N files of --tests that are nearest to the changed module by imports, without coverage",
    )
    parser.add_argument(
        "--forks",
        action="store_true",
        help="run the tests in forks of one pytest that has imported everything, and measure without coverage",
    )
    parser.add_argument(
        "--slowest",
        type=float,
        default=SLOWEST,
        metavar="S",
        help=f"with --forks, leave out tests that take more CPU seconds than this (default {SLOWEST:g})",
    )
    parser.add_argument(
        "--keep",
        type=Path,
        nargs="*",
        default=[],
        metavar="FILE",
        help="files to read the coverage from; a file that does not exist is written with the coverage of --tests",
    )
    parser.add_argument(
        "--patience",
        type=float,
        default=PATIENCE,
        metavar="S",
        help=f"seconds beyond three times the CPU time of the tests until a timeout (default {PATIENCE:g})",
    )
    parser.add_argument(
        "--budget",
        type=float,
        default=BUDGET,
        metavar="S",
        help=f"CPU seconds of tests per fault (default {BUDGET:g})",
    )
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*LEFT_OUT))
        precompiled(copy)
        nearest = Nearest(copy, given.package, tuple(given.tests))
        if given.nearest:
            reached = Reached.of_files([])
        elif given.without_coverage:
            reached = Reached.of_files(given.tests)
        else:
            measure = partial(measured_in_forks, slowest=given.slowest) if given.forks else measured
            reached = known(given.keep, lambda: measure(copy, given.package, given.tests))
        if not given.forks:
            collected(copy, sorted({test.partition("::")[0] for test in reached.tests}))
        chosen = sample(copy, given.package, set(given.only), given.each, given.seed, given.count)
        proven: dict[str, str] = json.loads(EQUIVALENT.read_text())
        outcomes = []
        with warm(copy, environment(copy)) as runner, ExitStack() as stack:
            forked = stack.enter_context(forks(copy, environment(copy), given.tests)) if given.forks else None
            for fault in chosen:
                if fault.name in proven:
                    print(f"equivalent  {fault.name}: {proven[fault.name]}", flush=True)
                    continue
                if given.nearest:
                    tests = nearest.files(fault.path, given.nearest)
                    reached.seconds |= dict.fromkeys(tests, 0.0)
                else:
                    tests = reached.within(given.budget, reached.at(fault.path, fault.lines), fault.path)
                outcome = None
                if forked and not reached.has(IMPORTED, fault.path, fault.lines):
                    outcome = tried_in_fork(fault, copy, tests, reached.seconds, forked, given.patience)
                outcomes.append(outcome or tried(fault, copy, tests, reached.seconds, runner, given.patience))
                print(
                    f"{outcomes[-1].word:<11} {fault.path}:{fault.line} {fault.kind}: {fault.was!r} → {fault.now!r}",
                    flush=True,
                )
    report(outcomes)


def sample(
    copy: Path, package: str, only: set[str], each: int, seed: int, count: int | None = None
) -> list[Fault]:
    """Choose `each` faults per package, or `count` in total; files are weighted by their possible faults."""
    chosen: list[Fault] = []
    folders = sorted(path for path in (copy / package).iterdir() if (path / "__init__.py").exists())
    homes = {path.name: sorted(path.rglob("*.py")) for path in folders if path.name not in ELSEWHERE}
    homes["."] = sorted((copy / package).glob("*.py"))
    homes = {name: files for name, files in homes.items() if not only or name in only}
    if count is not None:
        homes, each = {"all": [file for files in homes.values() for file in files]}, count
    for name, files in homes.items():
        all_ = [one for file in files for one in faults(file, file.relative_to(copy).as_posix())]
        chosen += random.Random(f"{seed} {name}").sample(all_, min(each, len(all_)))
    return chosen


def tried(
    fault: Fault,
    copy: Path,
    tests: Sequence[str],
    seconds: Mapping[str, float],
    runner: Runner,
    patience: float = PATIENCE,
) -> Outcome:
    """Insert a fault, run the tests that reach it, and remove it.

    The fault counts as caught if the failed test passes without it within the same time. After a timeout, all tests
    have to pass.
    """
    if not tests:
        return Outcome(fault, "unreached", 0)
    limit = patience + 3 * sum(seconds[test] for test in tests)
    word, suspects = "caught", tests
    try:
        with inserted(fault, copy):
            status, failed = tested(copy, tests, limit, runner)
    except subprocess.TimeoutExpired:
        word = "timeout"
    else:
        if not status:
            return Outcome(fault, "survived", len(tests))
        suspects = [failed] if failed else tests
    try:
        sound = tested(copy, suspects, limit, runner)[0] == 0
    except subprocess.TimeoutExpired:
        sound = False
    return Outcome(fault, word if sound else "unclear", len(tests))


def tried_in_fork(
    fault: Fault,
    copy: Path,
    tests: Sequence[str],
    seconds: Mapping[str, float],
    forked: Forks,
    patience: float = PATIENCE,
) -> Outcome | None:
    """Insert a fault, test it in a fork, and remove it; None if it needs a fresh process (see `tried`).

    The fault is caught if the same tests, up to the one that failed, pass without it within the same time.
    """
    if not tests:
        return Outcome(fault, "unreached", 0)
    limit = patience + SLOWED * sum(seconds[test] for test in tests)
    with inserted(fault, copy) as file:
        ran = forked(tests, limit, str(file), fault.line)
    without_caches(copy)
    if ran.status == str(UNCHANGED):
        return None
    if ran.status == "0":
        return Outcome(fault, "survived", len(tests))
    sound = bool(ran.started) and forked(ran.started, limit).status == "0"
    without_caches(copy)
    word = "timeout" if ran.status == "timeout" else "caught"
    return Outcome(fault, word if sound else "unclear", len(tests), ran.failed)


@contextmanager
def inserted(fault: Fault, copy: Path) -> Iterator[Path]:
    """Insert a fault into its file in the copy, yield the file, and remove the fault."""
    file = copy / fault.path
    text = file.read_bytes()
    file.write_bytes(fault.sown(text))
    try:
        yield file
    finally:
        file.write_bytes(text)


def tested(copy: Path, tests: Sequence[str], limit: float, runner: Runner) -> tuple[int, str]:
    """Return pytest's exit status and the first failed test; no test if pytest itself failed.

    Raise TimeoutExpired if the tests under one pytest.ini exceed the limit in seconds.
    """
    for arguments in apart(copy, tests):
        try:
            status, told = runner(
                [
                    "-q",
                    "-x",
                    "-rfE",
                    "-p",
                    "no:cacheprovider",
                    "--assert=plain",
                    "--no-header",
                    *arguments,
                ],
                limit,
            )
        finally:
            without_caches(copy)
        if status:
            lines = (line.split(" ", 1) for line in told.splitlines())
            first = next((line[1] for line in lines if line[0] in ("FAILED", "ERROR") and line[1:]), "")
            failed = [
                test for test in tests if first == test or first.startswith((f"{test} - ", f"{test}::"))
            ]
            return status, max(failed, key=len, default="")
    return 0, ""


def report(outcomes: Sequence[Outcome]) -> None:
    """Print the shares by package and in total, and the surviving faults."""
    words = ("caught", "timeout", "survived", "unreached", "unclear")
    packages = sorted({home(one) for one in outcomes})
    print(f"\n| package | faults | {' | '.join(words)} | share (95 % interval) |\n|{'---|' * 8}")
    for name in [*packages, "all"]:
        chosen = [one for one in outcomes if name in (home(one), "all")]
        counts = [sum(one.word == word for one in chosen) for word in words]
        print(f"| {name} | {len(chosen)} | {' | '.join(map(str, counts))} | {share(chosen)} |")
    print()
    for one in outcomes:
        if one.word in ("survived", "unreached", "unclear"):
            print(f"{one.word}: {one.fault.name} (line {one.fault.line}, {one.tests} tests)")


def share(outcomes: Sequence[Outcome]) -> str:
    """Return the share of caught faults for a table, with its exact (Clopper-Pearson) 95 % interval."""
    total, good = len(outcomes), sum(one.word in ("caught", "timeout") for one in outcomes)
    low = beta.ppf(0.025, good, total - good + 1) if good else 0.0
    high = beta.ppf(0.975, good + 1, total - good) if good < total else 1.0
    return f"{100 * good / max(1, total):.0f} % ({100 * low:.0f} % to {100 * high:.0f} %)"


def home(outcome: Outcome) -> str:
    """Return a fault's package."""
    parts = outcome.fault.path.split("/")
    return parts[1] if len(parts) > 2 else "."


if __name__ == "__main__":
    main()
