"""The conclusions of a watch and the text that states them, for evidence and processes written by hand."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.learning.bounds import Range
from pytest_tarl.monitoring import (
    assembling,
    bet_updates,
    conformal,
    dashboard,
    e_process,
    moments,
    restarts,
    stated,
    words,
)
from pytest_tarl.monitoring import monitor as monitor_module
from pytest_tarl.monitoring import status as module
from pytest_tarl.monitoring.moments import Moments
from pytest_tarl.monitoring.monitor import Counts, Monitor, begun, shares
from pytest_tarl.monitoring.scores import WHOLE
from pytest_tarl.monitoring.status import Evidence, Moment, Score, Status
from pytest_tarl.report.sensor_regions import Vocabulary
from tests.plugin.monitoring import missions

NOON = datetime(2026, 3, 1, 12, 30).timestamp()
QUIET = Evidence(0.0, 0.2, None, None)
LOUD = Evidence(3.0, 3.2, Moment(7, NOON), Moment(1200, None))
SUCCESS = stated.Bound("success", 0.9, 0.95)
TOTAL = stated.Bound("total", 2.5, 0.9, 0.0, 5.0)


def status(**changes: Any) -> Status:
    one = Status(1000, 950, 0.05, ((SUCCESS, QUIET),), QUIET, None, (), ())
    return replace(one, **changes)


def watch() -> Any:
    sample = SimpleNamespace(cells=tuple((x, wet) for x in range(4) for wet in range(2)))
    fixture = SimpleNamespace(test="t.py::test_a", sensors=missions.SENSORS, sample=sample)
    known = {"a": SimpleNamespace(path="a.log", missions=3, unfinished=1)}
    return SimpleNamespace(fixture=fixture, digest="d", known=known, problems=("p",))


def test_watch_without_an_alarm_prints_evidence() -> None:
    assert [*words.lines(watch(), status())] == [
        "t.py::test_a: 1,000 missions, 950 passed (95 %)",
        "  bound   at least 90 % of missions pass (95 % confidence): evidence 1, alarm at 20",
        "  world   missions as recorded: evidence 1, alarm at 20",
        (
            "  error   probability that this watch ever raises a false alarm: at most 5 % (alpha); 10 % "
            "including the 5 % risk that the bound itself is wrong"
        ),
    ]
    assert words.headline(watch(), status()) == (
        "1,000 missions, 950 passed (95 %); success bound: evidence 1, alarm at 20; world: evidence 1, alarm at 20"
    )
    alone = status(missions=1, passed=0, bounds=((SUCCESS, None),))
    assert words.headline(watch(), alone) == "1 mission, 0 passed (0 %); world: evidence 1, alarm at 20"
    assert words.headline(watch(), status(missions=0, passed=0, bounds=())).startswith(
        "0 missions, 0 passed; "
    )


def test_alarm_is_printed_with_onset_and_cells() -> None:
    found = status(
        world=LOUD,
        lead=Score("residual", (2, 1), "lower"),
        cells=((2, 0), (2, 1)),
        new=((3, 1),),
        notes=("one", "two"),
    )
    told = [*words.lines(watch(), found)]
    assert told[2:] == [
        (
            "  world   missions as recorded: ALARM with mission 1,200, changed before mission 7 (2026-03-01 12:30) "
            "(evidence 1,000, alarm at 20)"
        ),
        "          most of all the value of a visit to x 2-3, wet true is lower than recorded",
        "  where   x 2-3",
        "  new     x 3-4, wet true: no recorded episode visited it",
        told[-3],
        "  note    one",
        "  note    two",
    ]
    assert words.headline(watch(), found).endswith("; x 2-3")
    quiet = [*words.lines(watch(), replace(found, world=QUIET))]
    assert not [line for line in quiet if "most of all" in line]


@pytest.mark.parametrize(
    ("evidence", "expected"),
    [
        (None, "nothing to test"),
        (replace(QUIET, now=-1.0), "evidence 0.1, alarm at 20"),
        (replace(QUIET, now=1.0), "evidence 10, alarm at 20"),
        (replace(QUIET, now=4.99), "evidence 97,724, alarm at 20"),
        (replace(QUIET, now=5.0), "evidence 10^5, alarm at 20"),
        (replace(LOUD, since=None), "ALARM with mission 1,200 (evidence 1,000, alarm at 20)"),
        (replace(LOUD, since=None, highest=3.5), "ALARM with mission 1,200 (evidence 1,000, alarm at 20)"),
        (replace(LOUD, since=None, highest=4.0),
         "ALARM with mission 1,200 (evidence 1,000, alarm at 20, at most 10,000)"),
        (Evidence(3.0, 3.0, None, Moment(2, 0.0)), "ALARM with mission 2 (evidence 1,000, alarm at 20)"),
    ],
)  # fmt: skip
def test_evidence_is_printed_with_the_alarm_that_it_raised(evidence: Evidence | None, expected: str) -> None:
    assert words.found(evidence, 0.05) == expected


def test_bounds_scores_and_guarantees_are_described_in_words() -> None:
    assert words.stated(TOTAL) == "a mission earns at least 2.5 on average (90 % confidence)"
    some = Vocabulary(missions.SENSORS, ((0, 0), (0, 1)))
    assert (
        words.led(Score("steps", None, "spread"), some) == "the number of steps is more extreme than recorded"
    )
    assert words.led(Score("total", None, "higher"), some) == "the total reward is higher than recorded"
    both = status(bounds=((SUCCESS, QUIET), (TOTAL, QUIET)))
    assert both.error == pytest.approx(0.05 + 2 * 0.1)
    assert words.promise(both).endswith(
        "; 25 % including the 5 % and 10 % risk that the bounds themselves are wrong"
    )
    nothing = status(bounds=((SUCCESS, None),))
    assert nothing.error == 0.05
    assert (
        words.promise(nothing) == "probability that this watch ever raises a false alarm: at most 5 % (alpha)"
    )


def test_status_has_an_alarm_after_a_missed_bound_or_drift() -> None:
    for found, below, drifted in (
        (status(), False, False),
        (status(world=LOUD), False, True),
        (status(bounds=((SUCCESS, None), (TOTAL, LOUD))), True, False),
    ):
        assert (found.below, found.drifted, found.alarm) == (below, drifted, below or drifted)


def test_watch_json_has_evidence_and_alarm() -> None:
    found = dashboard.document(
        watch(), status(world=LOUD, lead=Score("residual", (2, 1), "lower"), cells=((2, 1),), new=((3, 1),))
    )
    assert found["world"] == {
        "evidence": {
            "log10_now": 3.0,
            "log10_highest": 3.2,
            "since": {"mission": 7, "time": NOON},
            "alarm": {"mission": 1200, "time": None},
        },
        "lead": {"score": "residual", "cell": [2, 1], "side": "lower"},
    }
    assert found["where"] == {"words": "x 2-3, wet true", "cells": [[2, 1]], "new": [[3, 1]]}
    assert found["logs"] == [{"path": "a.log", "missions": 3, "unfinished": 1}]
    assert (found["alarm"], found["passed"], found["fixture"], found["problems"]) == (True, 950, "d", ["p"])
    quiet = dashboard.document(watch(), status(bounds=((SUCCESS, None),)))
    assert quiet["bounds"] == [{"of": "success", "at_least": 0.9, "confidence": 0.95, "evidence": None}]
    assert quiet["world"]["lead"] is None
    assert quiet["where"]["words"] == ""


@given(st.lists(st.integers(1, 7), max_size=30), st.integers(2, 9))
def test_every_nth_time_is_kept_for_any_batching(portions: list[int], most: int) -> None:
    most *= 2
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(moments, "MOST", most)
        found, number = Moments(), 0
        for portion in portions:
            found.add(number, [float(n) for n in range(number, number + portion)])
            number += portion
        assert found.times == [float(n) for n in range(0, number, found.stride)]
        assert len(found.times) < most
        assert found.stride == 1 or 2 * (len(found.times) + 1) > most - 2
        for asked in (0, 1, number):
            kept = [time for time in found.times if time <= asked]
            assert found.at(asked) == (kept[-1] if kept else None)


def test_time_before_the_first_kept_mission_is_unknown() -> None:
    assert Moments().at(5) is None
    assert Moments(times=[3.5]).at(0) == 3.5


def test_a_bound_scales_values_to_its_range() -> None:
    assert TOTAL.share(np.array([-1.0, 0.0, 2.5, 5.0, 9.0])).tolist() == [0.0, 0.0, 0.5, 1.0, 1.0]


def recording(**told: Any) -> Any:
    passed = np.array([True] * 9 + [False])
    fixture = SimpleNamespace(sample=SimpleNamespace(passed=passed), stated=None)
    if told:
        success = SimpleNamespace(low=0.8, confidence=0.95)
        mean = SimpleNamespace(low=2.0, confidence=0.9)
        given_ = {"varied": True, "declared": None, "success": success, "mean": mean}
        fixture.stated = SimpleNamespace(**given_ | told)
    return fixture


def test_mean_bound_needs_a_declared_range() -> None:
    assert stated.bounds(recording(varied=False)) == ()
    assert stated.bounds(recording(varied=True)) == (stated.Bound("success", 0.8, 0.95),)
    declared = stated.bounds(recording(declared=(0.0, 5.0)))
    assert declared == (stated.Bound("success", 0.8, 0.95), stated.Bound("total", 2.0, 0.9, 0.0, 5.0))
    (older,) = stated.bounds(recording())
    assert older.what == "success"
    assert 0.5 < older.least < 0.9  # Clopper and Pearson of 9 of 10


def test_bet_gains_with_failures_and_loses_with_successes() -> None:
    found = e_process.factors(0.75, np.array([1.0, 0.0, 0.75]))
    assert found.shape == (3, restarts.BETS)
    shares_ = np.array(e_process.SHARES)
    assert found[0] == pytest.approx(1.0 - shares_)
    assert found[1] == pytest.approx(1.0 + 3.0 * shares_)
    assert found[2] == pytest.approx(np.ones(12))
    assert [e_process.testable(one) for one in (0.0, 0.5, 1.0)] == [False, True, False]


@pytest.mark.parametrize(
    ("bounds", "scores", "expected"),
    [
        (2, len(WHOLE) + 4, [0.25] * 2 + [0.05] * 5 + [0.0625] * 4),
        (0, len(WHOLE) + 4, [0.1] * 5 + [0.125] * 4),
        (1, len(WHOLE), [0.5] + [0.1] * 5),
        (0, len(WHOLE), [0.2] * 5),
    ],
)
def test_alpha_is_divided_among_bounds_missions_and_cells(
    bounds: int, scores: int, expected: list[float]
) -> None:
    assert shares(bounds, scores).tolist() == pytest.approx(expected)
    assert sum(expected) == pytest.approx(1.0)


def test_bounds_of_a_robot_have_fixed_array_columns() -> None:
    assert bet_updates.columns(2, 3, 4, 1).tolist() == [1, 5, 8 + 3, 8 + 4, 8 + 5]
    found = bet_updates.begun(np.array([1.0, 2.0, 3.0]), 1, 2)
    assert found.threshold.tolist() == [1.0, 1.0, 2.0, 3.0, 2.0, 3.0]


@pytest.fixture(scope="module")
def monitor(tmp_path_factory: pytest.TempPathFactory) -> Monitor:
    path = tmp_path_factory.mktemp("monitor") / "test.npz"
    fixture = missions.fixture(path, missions.walks(60, 1), Range(-20.0, 20.0))
    return begun(fixture, alpha=0.05, seed=0)


def changed(monitor: Monitor, **columns: dict[int, float]) -> Monitor:
    """Return the monitor with other values in some columns of its processes."""
    processes = restarts.begun(monitor.processes.threshold)
    for name, values in columns.items():
        column = getattr(processes, name)
        for row, value in values.items():
            column[..., row] = value
    return replace(monitor, processes=processes, moments=Moments(times=[100.0 * n for n in range(20)]))


def test_the_status_names_the_score_with_the_most_evidence(monitor: Monitor) -> None:
    stated_, cells = len(monitor.bounds), monitor.scale.cells
    first = stated_ + len(WHOLE)
    one = changed(
        monitor,
        age={stated_ + 1: 9, first + 2: 9},
        peak={stated_ + 1: 4.0, first + 2: 12.0},
        onset={first + 2: 4},
        alarm={first + 2: 8, stated_ + 1: 6},
        best={first + 2: 0.0},
    )
    one.processes.best[5, first + 2] = 1.0
    found = module.status(one)
    assert found.world.alarm == Moment(7, 600.0)
    assert found.world.since == Moment(5, 400.0)
    unit = -one.processes.threshold[first + 2] - np.log2(0.05)
    assert found.world.highest == pytest.approx((12.0 + unit) * np.log10(2.0))
    assert found.lead == Score("residual", cells[2], "higher")
    assert found.below is False
    one.processes.peak[stated_ + 1] = 30.0
    one.processes.best[2, stated_ + 1] = 1.0
    assert module.status(one).lead == Score("total", None, "lower")
    one.processes.best[8, stated_ + 1] = 2.0
    assert module.status(one).lead == Score("total", None, "spread")


def test_monitor_without_missions_has_no_onset(monitor: Monitor) -> None:
    found = module.status(changed(monitor))
    assert (found.lead, found.world.since, found.world.alarm, found.cells) == (None, None, None, ())
    assert found.world.now == pytest.approx(found.world.highest)


def test_new_cells_are_named_after_two_missions_visited_them(monitor: Monitor) -> None:
    found = replace(changed(monitor), new={(9, 1): 2, (8, 0): 2, (7, 0): 1})
    assert module.status(found).new == ((8, 0), (9, 1))


def test_only_known_new_cells_are_counted(monitor: Monitor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(monitor_module, "MOST_NEW", 2)
    one = replace(changed(monitor), new={})
    nothing = np.zeros(0)
    for cell in ((9, 1), (8, 0), (7, 0), (9, 1), (8, 0), (9, 1)):
        one.told(np.zeros(0, bool), nothing, np.zeros(0, np.int64), nothing, [cell])
    assert one.new == {(9, 1): 3, (8, 0): 2}


def test_missions_that_were_judged_in_other_processes_are_counted(monitor: Monitor) -> None:
    one = replace(changed(monitor), new={}, counts=Counts(), moments=Moments())
    lost = np.array([np.nan, 1.0, np.nan, 99.0])
    for first in (0, 4):
        times = np.arange(4.0) + 100.0 + first
        one.told(np.array([True, False, True, True]), lost, np.array([0, 3, 5, 7]), times, [(9, 9)])
        counted = first + 4
        assert (one.counts.missions, one.counts.passed) == (counted, 3 * counted // 4)
        assert (one.counts.without_steps, one.counts.without_rewards) == (counted // 4, counted // 4)
    assert one.counts.beyond_range == 2  # 99 is beyond the range from -20 to 20
    assert one.new == {(9, 9): 2}
    assert [one.moments.at(n) for n in (0, 7)] == [100.0, 107.0]


def test_a_monitor_notes_missing_bounds_and_incomplete_missions(monitor: Monitor) -> None:
    one = changed(monitor)
    assert module.status(one).notes == ()
    counts = replace(one.counts, without_steps=1, without_rewards=1000, beyond_range=2)
    assert [note.partition(" with")[0] for note in module._notes(replace(one, counts=counts, bounds=()))] == [
        "All episodes of the recording are equal, so it has no bound to test.",
        "1 mission",
        "1,000 missions",
        "2 missions",
    ]


def test_bin_edges_lie_midway_between_values() -> None:
    found = conformal.edges(np.array([0.0, 1.0, 1.0, 4.0]), 1.0)
    finite = found[np.isfinite(found)]
    spread = 4.0
    away = [spread * 2.0**n for n in range(-7, 1)]
    expected = [*(-one for one in reversed(away)), 0.5, 2.5, *(4.0 + one for one in away)]
    assert finite == pytest.approx(expected)
    assert found.size == conformal.BINS - 1
    alone = conformal.edges(np.array([3.0]), 2.0)
    assert alone[np.isfinite(alone)][-1] == pytest.approx(3.0 + 2.0)
    assert conformal.edges(np.empty(0), 0.0)[0] == -1.0


def test_each_score_is_counted_in_its_bin() -> None:
    pool = np.zeros((2, conformal.BINS), np.int64)
    found = conformal.joined(pool, np.array([[3, -1], [3, 5]]))
    assert (found[0, 3], found[1, 5], found.sum()) == (2, 1, 3)
    assert pool.sum() == 0


@pytest.mark.parametrize(
    ("told", "expected"), [(5.0, 5.0), (b"7.5", 7.5), (-1.0, 0.0), (1e30, 0.0), (0.0, 0.0)]
)
def test_the_time_of_a_wrong_clock_is_none(told: float | bytes, expected: float) -> None:
    assert assembling.valid_time(told) == expected
