"""Formulas over many episodes: in recordings, in comparisons, as the reward."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rtamt")

from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.formulas.judging import Judge
from pytest_tarl.formulas.parsing import formula
from pytest_tarl.learning import fixture as fixtures
from pytest_tarl.learning.judgements import judgements, stacked, world
from pytest_tarl.report.json_result import schema
from tests.plugin.tank import ONLINE, RECORD, changed

FILLS, KEEPS = "eventually[0:2.4] (level > 0.9)", "always (missing < 1.1)"
REQUIRES = f'requires=["{FILLS}", "{KEEPS}"], signals=["missing"],'


def required(tank: pytest.Pytester, more: str = "") -> None:
    changed(tank, "test_tank", "    min_success=0.9,", f"    min_success=0.9, {REQUIRES} {more}")
    reward = "        tarl.reward(-abs(1.0 - level))\n"
    observed = "        tarl.observe(missing=abs(1.0 - level))\n"
    changed(tank, "test_tank", reward, observed + ("" if "robustness" in more else reward))
    changed(tank, "test_tank", '    assert abs(1.0 - level) < 0.1, "tank not full"\n', "")


def recorded(tank: pytest.Pytester) -> Path:
    (path,) = tank.path.glob(".tarl/utility/*.npz")
    return path


def test_the_recording_contains_robustness_by_episode(tank: pytest.Pytester) -> None:
    required(tank)
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    judged = fixtures.load(recorded(tank)).sample.judgements
    assert judged is not None
    assert judged.formulas == (KEEPS, FILLS)
    assert judged.robustness.shape == (16, 2)
    assert (judged.robustness > 0).all()
    assert np.isnan(judged.lost).all()


def test_workers_give_an_identical_recording(tank: pytest.Pytester) -> None:
    required(tank)
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    alone = recorded(tank).read_bytes()
    tank.runpytest_subprocess("-q", *RECORD, "--tarl-workers=2").assert_outcomes(passed=1, deselected=1)
    assert recorded(tank).read_bytes() == alone


def test_a_recording_without_formulas_is_unchanged(tank: pytest.Pytester) -> None:
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    with np.load(recorded(tank), allow_pickle=False) as archive:
        header = json.loads(archive[fixtures.HEADER].tobytes().decode())
        assert not {"robustness", "lost"} & set(archive.files)
    assert not {"formulas", "signals"} & set(header)
    assert fixtures.load(recorded(tank)).sample.judgements is None


def test_a_comparison_has_one_row_per_formula(tank: pytest.Pytester) -> None:
    required(tank)
    tank.runpytest("-q", *RECORD)
    result = tank.runpytest("-q", *ONLINE)
    assert f"formula {FILLS}: designed 0" in " ".join(result.stdout.str().split())
    assert "violated in 12 of 12, first at 2.4 s" in " ".join(result.stdout.str().split())
    (path,) = tank.path.glob(".tarl/results/*.json")
    document = json.loads(path.read_text())
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(document, schema())
    rows = {row["formula"]: row["worlds"] for row in document["formulas"]}
    assert rows[FILLS]["online"]["violated"] == 12
    assert rows[FILLS]["online"]["first_violation"] == 2.4
    assert rows[FILLS]["offline"]["violated"] == 0
    assert rows[FILLS]["repaired"] is None
    (page,) = tank.path.glob(".tarl/report/*.html")
    assert "eventually[0:2.4] (level &gt; 0.9)" in page.read_text()


def test_a_violated_formula_prevents_a_recording(tank: pytest.Pytester) -> None:
    required(tank)
    changed(tank, "test_tank", "[0:2.4]", "[0:0.2]")
    result = tank.runpytest("-q", *RECORD)
    result.assert_outcomes(failed=1, deselected=1)
    assert "requirement violated at 0.2 s: eventually[0:0.2] (level > 0.9)" in " ".join(
        result.stdout.str().split()
    )
    assert not list(tank.path.glob(".tarl/utility/*.npz"))


def test_a_formula_longer_than_every_episode_is_reported(tank: pytest.Pytester) -> None:
    required(tank)
    changed(tank, "test_tank", "[0:2.4]", "[20:24]")
    result = tank.runpytest("-q", *RECORD)
    result.assert_outcomes(failed=1, deselected=1)
    assert "can never be judged: its time bounds exceed the length of all 16 episodes" in " ".join(
        result.stdout.str().split()
    )


def test_rewards_add_up_to_the_robustness(tank: pytest.Pytester) -> None:
    required(tank, 'reward="robustness",')
    tank.runpytest("-q", *RECORD).assert_outcomes(passed=1, deselected=1)
    sample = fixtures.load(recorded(tank)).sample
    assert sample.judgements is not None
    assert sample.total == pytest.approx(sample.judgements.robustness.min(axis=1))
    assert (sample.steps == 25).all()
    assert "degraded" in tank.runpytest("-q", *ONLINE).stdout.str()


@given(st.lists(st.floats(-5, 5), min_size=1, max_size=12), st.floats(0.5, 3), st.integers(1, 12))
def test_the_rewards_of_steps_add_up_within_the_cap(values: list[float], cap: float, first: int) -> None:
    judge = Judge(("x",), [formula("here", "always[0:3] (x > 0) and eventually (x > 1)", ("x",))])
    for step, value in enumerate(values, start=1):
        judge.steps.append(step * 10**9)
        if step >= first:
            judge.give("x", value, step * 10**9)
    end = len(values) * 10**9
    rewards = judge.rewards(end, cap)
    assert len(rewards) == len(values)
    assert all(map(math.isfinite, rewards))
    known = len(values) >= first
    final = judge.conclude(end)[0].robustness if known else -cap
    assert sum(rewards) == pytest.approx(max(-cap, min(cap, final)), abs=1e-9)


def test_episodes_without_a_judgement_are_ignored() -> None:
    judge = Judge(("x",), [formula("here", "always[3:4] (x > 0)", ("x",))])
    judge.give("x", 2.0, 0)
    short, long = judge.conclude(10**9), judge.conclude(4 * 10**9)
    found = world(stacked([short, long, ()]), "always[3:4] (x > 0)")
    assert found is not None
    assert (found.episodes, found.violated, found.robustness) == (1, 0, 2.0)
    assert world(judgements(short), "always[3:4] (x > 0)") is None
