"""Random cases are the same in every run, unless a run has a seed; each nightly run has a new one and prints it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from website.other_plugins import BLOCKED

ROOT = Path(__file__).parent.parent
CASES = """\
from hypothesis import given, settings, strategies
from tests.slow import chance

drawn = []

@given(strategies.integers())
@settings(max_examples=20)
def test_draws(number):
    drawn.append(number)

def test_shows():
    print("drawn:", drawn, chance("other").random())
"""
SEEDED = re.compile(r"^random cases: repeat them with TARL_SEED=(\d+)$", re.MULTILINE)


@pytest.fixture
def cases(tmp_path: Path) -> Path:
    """Return a file of tests that print their random cases."""
    (tmp_path / "test_cases.py").write_text(CASES)
    return tmp_path / "test_cases.py"


def drawn(cases: Path, variables: Mapping[str, str], *flags: str) -> tuple[str, list[str]]:
    """Return the random cases of a run with the hooks of this suite, and the seeds that it prints."""
    usual = {name: value for name, value in os.environ.items() if not name.startswith(("TARL_", "PYTEST_"))}
    hooks = ["-p", "hypothesispytest", "-p", "tests.conftest", "-p", "no:cacheprovider"]
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", *hooks, "-qs", *flags, "-c", os.devnull, str(cases)],
        cwd=ROOT,
        env={**usual, **variables, "PYTHONPATH": str(ROOT), "PYTEST_ADDOPTS": BLOCKED},
        capture_output=True,
        text=True,
        check=True,
    )
    (line,) = re.findall(r"drawn: .*", ran.stdout)
    return line, SEEDED.findall(ran.stdout)


def test_random_cases_depend_only_on_the_seed(cases: Path) -> None:
    usual, one, again, other = (
        drawn(cases, variables)
        for variables in ({}, {"TARL_SEED": "1"}, {"TARL_SEED": "1"}, {"TARL_SEED": "2"})
    )
    assert (usual[1], one[1], other[1]) == ([], ["1"], ["2"])
    assert one == again
    assert len({usual[0], one[0], other[0]}) == 3
    assert drawn(cases, {}) == usual


def test_each_slow_run_draws_new_cases_and_prints_its_seed(cases: Path) -> None:
    (one, [seed]), (other, [another]) = (drawn(cases, {"TARL_SLOW": "1"}) for _ in range(2))
    assert (seed != another, one != other) == (True, True)
    assert drawn(cases, {"TARL_SLOW": "1", "TARL_SEED": seed}) == (one, [seed])


def test_the_seed_of_hypothesis_has_an_effect(cases: Path) -> None:
    usual, one, again = (drawn(cases, {}, *flags) for flags in ((), *[("--hypothesis-seed=1",)] * 2))
    assert usual[0] != one[0] == again[0]
