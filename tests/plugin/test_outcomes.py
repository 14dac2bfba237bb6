"""What an episode's reports and errors mean: passed, failed, broken, skipped or unusable."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.design import AS_WRITTEN
from pytest_tarl.errors import NodeError, RecordingError, SettingsError, StuckNodeError, TarlError
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.item_episode import Episode, _first_paragraph
from pytest_tarl.repeating import _outcome
from pytest_tarl.rollout import EpisodePlan, EpisodeRun

TRACE = Trace((), *(np.zeros(0, np.int32), np.zeros(0), *(np.zeros(0, np.int32),) * 3), np.zeros(0), {})


def report(when: str = "call", outcome: str = "passed", told: Any = "", **more: Any) -> Any:
    return SimpleNamespace(
        when=when,
        failed=outcome == "failed",
        skipped=outcome == "skipped",
        longrepr=told,
        longreprtext=str(told),
        **more,
    )


def ran(*reports: Any, **changed: Any) -> EpisodeRun:
    marked: Any = None
    return _outcome(Episode(EpisodePlan(3), marked, **{"trace": TRACE, **changed}), [*reports])


def told(run: EpisodeRun) -> tuple[bool, str, str, bool, bool]:
    return run.passed, run.failure, run.broken, run.crashed, run.stuck


FAILED = report(outcome="failed", told="assert 1 == 2")


def test_a_mission_without_a_failed_report_has_passed() -> None:
    assert told(ran(report("setup"), report(), report("teardown"))) == (True, "", "", False, False)


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (AssertionError("too far"), (False, "too far", "", False, False)),
        (pytest.fail.Exception("too late"), (False, "too late", "", False, False)),
        (pytest.fail.Exception("Timeout (>5.0s) from pytest-timeout."), None),
        (KeyError("speed"), (False, "", "assert 1 == 2", False, False)),
    ],
)
def test_a_failed_mission_is_distinguished_from_a_broken_test(error: BaseException, expected: Any) -> None:
    run = ran(FAILED, error=error)
    if expected is None:
        assert (run.passed, run.stuck) == (False, True)
    else:
        passed, failure, *rest = told(run)
        assert (passed, *rest) == (expected[0], *expected[2:])
        assert expected[1] in failure
        assert bool(failure) == bool(expected[1])


def test_raising_node_crashed_and_waiting_free_node_is_stuck() -> None:
    run = ran(FAILED, error=NodeError("Node '/a' raised KeyError."))
    assert (run.passed, run.crashed, run.stuck, run.broken) == (False, True, False, "")
    run = ran(FAILED, error=StuckNodeError("Node '/a' never waits."))
    assert (run.passed, run.stuck) == (False, True)


def test_setup_failure_is_outside_the_mission() -> None:
    error = AssertionError("too far")
    run = ran(report("setup", "failed", "no fixture"), error=error)
    assert (run.passed, run.broken) == (False, "no fixture")
    run = ran(FAILED, report("teardown", "failed", "leak"), error=error)
    assert run.broken == "leak"
    run = ran(report(), report("teardown", "failed", "leak"))
    assert (run.passed, run.failure, run.broken) == (False, "", "leak")


def test_settings_error_is_raised() -> None:
    with pytest.raises(SettingsError, match="wrong"):
        ran(FAILED, error=SettingsError("wrong"))
    problem = RecordingError("no reward")
    for error in (None, AssertionError("too far")):
        with pytest.raises(RecordingError, match="no reward"):
            ran(FAILED, error=error, problem=problem)
    assert ran(FAILED, error=NodeError("Node '/a' raised KeyError."), problem=problem).crashed
    assert ran(FAILED, error=KeyError("speed"), problem=problem).broken


def test_skipped_test_is_skipped_unless_a_bag_was_replayed() -> None:
    skipped = report("setup", "skipped", ("t.py", 3, "Skipped: no arm"))
    with pytest.raises(pytest.skip.Exception, match="no arm"):
        ran(skipped)
    with pytest.raises(pytest.skip.Exception, match="plainly"):
        ran(report(outcome="skipped", told="plainly"))
    assert ran(skipped, replayed=True).passed


def test_xfail_mark_does_not_change_a_mission_result() -> None:
    run = ran(report(outcome="skipped", told="reason", wasxfail="reason"), error=AssertionError("too far"))
    assert (run.passed, run.broken) == (False, "")
    assert ran(report(outcome="failed", told="[XPASS(strict)] reason")).passed
    assert not ran(report("teardown", "failed", told="[XPASS(strict)] reason")).passed


def test_a_test_without_the_fixture_is_explained() -> None:
    with pytest.raises(TarlError, match="ended without its fixture `tarl`"):
        ran(report(), trace=None)
    with pytest.raises(TarlError, match="no fixture"):
        ran(report("setup", "failed", "no fixture"), trace=None)


def test_the_first_paragraph_of_a_docstring_is_one_line() -> None:
    assert _first_paragraph("  Fill the tank\n  quickly.\n\nDetails.") == "Fill the tank quickly."
    assert _first_paragraph(None) == ""
    assert AS_WRITTEN == "none"
