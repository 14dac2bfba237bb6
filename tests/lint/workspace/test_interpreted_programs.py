"""Random programs have the results that Python computes, and nothing of them is unknown."""

from __future__ import annotations

import importlib
import random
from pathlib import Path
from typing import Any

import pytest

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
FAILURES = (ArithmeticError, LookupError, TypeError, ValueError, AttributeError, SyntaxError)


@pytest.fixture
def programs(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("interpreted_programs")


@pytest.mark.parametrize("seed", range(4))
def test_random_programs_have_the_same_results_as_in_python(tmp_path, programs, seed):
    compared = 0
    for number in range(20):
        text = programs.Programs(random.Random(f"{seed} {number}")).program()
        try:
            results, wrong = programs.compared(text, tmp_path)
        except FAILURES:
            continue
        assert wrong == [], text
        compared += results
    assert compared > 20


def test_the_comparison_notices_a_wrong_result(tmp_path, programs):
    text = "import os\nr = [1, len(os.environ) - len(os.environ)]\n"
    results, wrong = programs.compared(text, tmp_path)
    assert results == 2
    assert len(wrong) == 1
