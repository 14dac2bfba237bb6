"""Compare a world with itself, with a recording on disk and the command line: constant rewards give no difference.

The worlds are those of benchmarks/same_worlds; how often a difference is reported between equal worlds is measured in
benchmarks/same_world.py. Here the seeds are fixed, so the results are always the same.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

WORLDS = Path(__file__).resolve().parent.parent.parent / "benchmarks" / "same_worlds"


@pytest.fixture
def worlds(pytester: pytest.Pytester) -> pytest.Pytester:
    for path in WORLDS.glob("*.py"):
        shutil.copy(path, pytester.path)
    pytester.makeini("[pytest]\naddopts = -p no:randomly -p no:asyncio -p no:rerunfailures\n")
    return pytester


def results(project: pytest.Pytester) -> dict[str, Any]:
    """Return the JSON results by the name of the test."""
    found = [json.loads(path.read_text()) for path in (project.path / ".tarl" / "results").glob("*.json")]
    return {one["test"].partition("::test_")[2]: one for one in found}


def test_new_seeds_in_the_same_world_give_no_difference(worlds: pytest.Pytester) -> None:
    worlds.runpytest("--tarl-record", "--tarl-episodes=40", "--tarl-seed=1").assert_outcomes(passed=9)
    worlds.runpytest("--tarl-online", "--tarl-episodes=20", "--tarl-seed=2").assert_outcomes(passed=9)
    found = results(worlds)
    assert {name for name, one in found.items() if one["verdict"]["result"] != "no difference"} == set()
    assert found["equal_lengths"]["verdict"]["p_loss"] == 1.0
    assert found["there_and_back"]["atr"]["offline"] == found["there_and_back"]["atr"]["online"] == 0.0


def test_a_small_additional_cost_is_detected(worlds: pytest.Pytester) -> None:
    chosen = "test_rewards.py::test_constant_cost"
    worlds.runpytest("--tarl-record", "--tarl-episodes=40", chosen)
    test = worlds.path / "test_rewards.py"
    test.write_text(test.read_text().replace("tarl.reward(-0.1)", "tarl.reward(-0.10001)"))
    worlds.runpytest("--tarl-online", "--tarl-episodes=20", "--tarl-seed=2", chosen).assert_outcomes(passed=1)
    assert results(worlds)["constant_cost"]["verdict"]["result"] == "drifted"
