"""The examples as a newcomer meets them: ordinary tests in a folder of their own."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec

import pytest

from tests.examples.driving import EXAMPLES

FORMULAS = sys.version_info < (3, 13) and find_spec("rtamt") is not None


@pytest.mark.parametrize(("example", "tests"), [("shuttle", 3), ("line_follower", 1), ("quadrotor", 1)])
def test_an_example_passes_without_flags_in_its_own_folder(example: str, tests: int) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=EXAMPLES / example,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    by_formula = (EXAMPLES / example / "test_by_formula.py").exists() and FORMULAS
    assert f"{tests + by_formula} passed" in run.stdout
    assert "TARL" not in run.stdout


def test_the_swapped_node_differs_by_the_order_of_two_lines_only() -> None:
    here, there = (
        (EXAMPLES / "shuttle" / f"{name}.py").read_text() for name in ("traveller", "traveller_swapped")
    )
    swapped = re.sub(r"( +err = .*\n)( +vel = .*\n)", r"\2\1", here)
    assert swapped != here
    assert swapped == there
