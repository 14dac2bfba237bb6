"""Bounds that a recording states, and the number of episodes needed for a requested confidence."""

from __future__ import annotations

import pytest

from pytest_tarl.learning.fixture import load
from tests.plugin.tank import ONLINE, RECORD, changed, fixture_file, result


def said(tank: pytest.Pytester, *lines: str) -> None:
    tank.runpytest(*RECORD).stdout.fnmatch_lines(list(lines))


def test_recording_prints_bounds_and_saves_them(tank: pytest.Pytester) -> None:
    said(
        tank,
        "  16 of 16 missions succeeded: success rate at least 82.9 % with 95 % confidence, over the "
        "worlds that this test samples",
        "  mean reward -* per mission: at least -* with 95 % confidence (approximate: no total_range is declared)",
        "  stating a reward that 95 % of the missions reach needs 59 episodes, 43 more than were run",
    )
    stated = load(fixture_file(tank)).stated
    assert stated is not None
    assert stated.success.low == pytest.approx(0.05 ** (1 / 16))
    assert not stated.mean.exact


def test_declared_range_makes_the_mean_exact(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "min_success=0.9,", "min_success=0.9,\n    total_range=(-25, 0),")
    said(tank, "*with 95 % confidence (totals within the declared range)")
    stated = load(fixture_file(tank)).stated
    assert stated is not None
    assert stated.mean.exact
    assert -25 < stated.mean.low < stated.average


def test_a_total_outside_the_declared_range_is_an_error(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "min_success=0.9,", "min_success=0.9,\n    total_range=(-2, 0),")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*earned -*, outside the marker's total_range=(-2.0, 0.0)*"])


def test_equal_episodes_are_reported_as_one_tested_world(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "draws.uniform(0.0, 0.2)", "0.1")
    changed(tank, "test_tank", " + float(draws.normal(0, 0.005))", "")
    said(tank, "  only one world was tested: all 16 episodes are equal*")


def test_stated_confidence_prolongs_recording(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "min_success=0.9,", "min_success=0.9,\n    confidence=0.9,")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    stated = load(fixture_file(tank)).stated
    assert stated is not None
    assert 16 < stated.episodes < 60
    assert stated.success.low >= 0.9
    assert stated.success.method == "confidence sequence"


def test_too_many_failures_end_the_recording(tank: pytest.Pytester) -> None:
    changed(tank, "test_tank", "min_success=0.9,", "min_success=0.9,\n    confidence=0.9,")
    changed(tank, "test_tank", "< 0.1, ", "< 0.1 and draws.random() < 0.5, ")
    told = tank.runpytest(*RECORD)
    told.assert_outcomes(failed=1, deselected=1)
    told.stdout.fnmatch_lines(["*of * episodes failed: at confidence=0.9, the success rate is below 0.9*"])


@pytest.mark.parametrize(
    ("marked", "sentence"),
    [
        ("confidence=0.95, min_success=1.0,", "*confidence=0.95 needs a min_success below 1*"),
        ("confidence=1.0, min_success=0.9,", "*confidence must be a number from 0.5 to 1*"),
        ("total_range=(1, 0), min_success=0.9,", "*total_range must be two finite bounds*"),
        ("total_range=3, min_success=0.9,", "*total_range must be two finite bounds*"),
    ],
)
def test_an_unreachable_confidence_is_a_usage_error(
    tank: pytest.Pytester, marked: str, sentence: str
) -> None:
    changed(tank, "test_tank", "min_success=0.9,", marked)
    tank.runpytest(*RECORD).stdout.fnmatch_lines([sentence])


def test_a_comparison_prints_the_recorded_bounds(tank: pytest.Pytester) -> None:
    tank.runpytest(*RECORD)
    tank.runpytest(*ONLINE).stdout.fnmatch_lines(
        ["  bounds   designed: success at least 82.9 %, mean reward approximately*"]
    )
    assert result(tank)["bounds"]["offline"]["success"]["low"] == pytest.approx(0.05 ** (1 / 16))
    (page,) = (tank.path / ".tarl" / "report").glob("*.html")
    assert "at least 82.9 %" in page.read_text("utf-8")
