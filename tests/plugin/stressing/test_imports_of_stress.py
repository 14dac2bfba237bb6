"""Packages that only the stress search needs are imported only under its flag."""

from __future__ import annotations

import pytest

from tests.plugin.stressing.test_stress import STRESS, spaced
from tests.plugin.tank import ONLINE, RECORD

__all__ = ["spaced"]  # a fixture

ONLY_STRESS = ("cma", "hypothesis", "SALib")
PRINTS = f"""
import sys

def pytest_unconfigure():
    print("\\nimported:", [one for one in {ONLY_STRESS} if one in sys.modules])
"""


def imported(project: pytest.Pytester, *flags: str) -> str:
    """Return the line that tells which of the packages a run in a process of its own has imported."""
    project.makeconftest(PRINTS)
    done = project.runpytest_subprocess("-p", "no:hypothesispytest", *flags)
    (line,) = [one for one in done.outlines if one.startswith("imported:")]
    return line


def test_other_modes_import_no_package_of_the_stress_search(spaced: pytest.Pytester) -> None:
    for flags in ((), RECORD, ONLINE):
        assert imported(spaced, *flags) == "imported: []", flags


def test_the_stress_search_imports_its_packages(spaced: pytest.Pytester) -> None:
    assert "hypothesis" in imported(spaced, *STRESS)
