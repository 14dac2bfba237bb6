"""Measure which tests reach which lines of a package, with coverage or with marks (see `reach_marks.py`)."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from forked_tests import SLOWEST, forks
from reach_marks import FOLDER, compiled
from reached_lines import Reached, from_coverage, read
from tested_copy import apart, environment, with_own_settings

SETTINGS = """[run]
source = {source}
parallel = true
patch = _exit
context = ${{TEST_OF_MUTANTS-}}
data_file = {data}
"""
TIMES = """
import json, os
from pathlib import Path
import pytest
passed, owner, begun = {}, os.getpid(), {}
@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item):
    begun[item.nodeid] = sum(os.times()[:4])
def pytest_runtest_logreport(report):
    if report.when == "call" and report.passed and report.nodeid in begun:
        passed[report.nodeid] = sum(os.times()[:4]) - begun[report.nodeid]
def pytest_unconfigure():
    if os.getpid() == owner and not os.environ.get("PYTEST_CURRENT_TEST"):
        Path(os.environ["TEST_TIMES"]).write_text(json.dumps(passed))
import coverage
def pytest_runtest_setup(item):
    os.environ["TEST_OF_MUTANTS"] = item.nodeid  # for child processes; a test may run pytest inside
    if (current := coverage.Coverage.current()) is not None:
        current.switch_context(item.nodeid)
"""


def known(keep: Sequence[Path], measure: Callable[[], Reached]) -> Reached:
    """Return which tests reach which lines: measured, or read from the files."""
    if not keep:
        return measure()
    reached = Reached()
    for file in keep:
        if not file.exists():
            measure().write(file)
        reached.add(read(file))
    return reached


def measured_in_forks(copy: Path, package: str, tests: Sequence[str], slowest: float = SLOWEST) -> Reached:
    """Run the tests once with marks in the package (see `reach_marks.py`)."""
    with tempfile.TemporaryDirectory(prefix="marks-") as folder:
        compiled(copy, package, Path(folder))
        start = f"import sys\nsys.path.append({str(Path(__file__).parent)!r})\n"
        start += "import reach_marks\nreach_marks.install()\n"
        (Path(folder) / "sitecustomize.py").write_text(start)
        surroundings = {**environment(copy), FOLDER: folder}
        surroundings["PYTHONPATH"] += os.pathsep + folder
        with forks(copy, surroundings, tests) as running:
            return running.measured(slowest)


def measured(copy: Path, package: str, tests: Sequence[str]) -> Reached:
    """Run the tests once with coverage."""
    with tempfile.TemporaryDirectory() as folder:
        settings, data = Path(folder) / "rc", Path(folder) / "data"
        settings.write_text(SETTINGS.format(source=copy / package, data=data))
        (Path(folder) / "test_times.py").write_text(TIMES)
        surroundings = {
            **environment(copy),
            "COVERAGE_PROCESS_START": str(settings),
        }
        surroundings["PYTHONPATH"] += os.pathsep + folder
        own = [sys.executable, "-m", "coverage"]
        run = [
            *own,
            "run",
            f"--rcfile={settings}",
            "-m",
            "pytest",
            "-q",
            "-p",
            "test_times",
            "-p",
            "no:cacheprovider",
        ]
        seconds: dict[str, float] = {}
        for arguments in apart(copy, with_own_settings(copy, tests)):
            times = Path(folder) / "times.json"
            with_times = {**surroundings, "TEST_TIMES": str(times)}
            subprocess.run([*run, *arguments], cwd=copy, env=with_times, check=False, stdout=sys.stderr)
            seconds |= json.loads(times.read_text())
        subprocess.run(
            [*own, "combine", f"--rcfile={settings}", "-q"], cwd=copy, env=surroundings, check=True
        )
        return from_coverage(data, copy, seconds)
