"""The reports of finished tests to pytest."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import finished_tests
from pytest_tarl.accounts import Account
from pytest_tarl.errors import FixtureError, RecordingError
from pytest_tarl.finished_tests import FinishedTest, passed, started
from pytest_tarl.terminal_summary import ACCOUNT


class Hooks:
    """The hooks of an item, which note their calls."""

    def __init__(self) -> None:
        self.calls: list[Any] = []

    def __getattr__(self, name: str) -> Any:
        return lambda **given: self.calls.append((name, given))


class Item:
    """The item of the running test, with hooks that note their calls."""

    def __init__(self, node: pytest.Item) -> None:
        self._node = node
        self.ihook: Any = Hooks()
        self.user_properties: list[Any] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._node, name)


@pytest.fixture
def item(request: pytest.FixtureRequest) -> Any:
    return Item(request.node)


def report(outcome: str = "passed") -> Any:
    return SimpleNamespace(outcome=outcome, passed=outcome == "passed", user_properties=[])


def finished(item: Any, run: Any) -> FinishedTest:
    call: Any = pytest.CallInfo.from_call(run, when="call")
    return FinishedTest(item, call, report(), report())


def raising(error: BaseException, context: BaseException | None = None) -> Any:
    def run() -> None:
        error.__context__ = context
        raise error

    return run


def logged(one: FinishedTest) -> Any:
    """Return the report of the test's body, and check the order of all reports."""
    hooks: Any = one.item.ihook
    hooks.calls.clear()
    one.log()
    names = [name for name, _ in hooks.calls]
    assert names == ["pytest_runtest_logreport"] * 3 + ["pytest_runtest_logfinish"]
    reports = [given["report"] for name, given in hooks.calls[:3]]
    assert (reports[0], reports[2]) == (one.setup, one.teardown)
    return reports[1]


def test_account_is_attached_to_both_reports(item: Any) -> None:
    one = finished(item, lambda: Account(("line",), properties=(("tarl_verdict", "drifted"),)))
    found = logged(one)
    assert (found.outcome, getattr(found, ACCOUNT)["lines"]) == ("passed", ["line"])
    assert found.user_properties == one.teardown.user_properties == [("tarl_verdict", "drifted")]


def test_problem_fails_the_test_in_print(item: Any) -> None:
    found = logged(finished(item, lambda: Account((), problem="degraded\x1b[1m")))
    assert (found.outcome, found.longrepr) == ("failed", "degraded\\x1b[1m")


def test_an_error_of_tarl_is_shown_without_its_traceback(item: Any) -> None:
    one = finished(item, raising(RecordingError("no reward\x07")))
    assert one.outcome is None
    found = logged(one)
    assert (found.outcome, found.longrepr) == ("failed", "no reward\\x07")
    assert not hasattr(found, ACCOUNT)


def test_a_test_without_a_recording_is_skipped_and_counted(item: Any) -> None:
    skip = pytest.skip.Exception("t has no recorded utility", _use_item_location=False)
    found = logged(finished(item, raising(skip, FixtureError("t has no recorded utility"))))
    assert found.outcome == "skipped"
    account = getattr(found, ACCOUNT)
    assert account["unrecorded"] is True
    assert "t has no recorded utility" in account["lines"][0]
    other = logged(finished(item, raising(pytest.skip.Exception("no arm"))))
    assert not hasattr(other, ACCOUNT)


def test_further_stage_replaces_the_result(item: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    again = report("failed")
    monkeypatch.setattr(finished_tests, "finish", lambda *_: again)
    one = finished(item, lambda: "first")
    start, one.call.duration = one.call.start, 5.0
    asked: list[Any] = []
    stage: Any = "stage"
    one.proceed(lambda *given: asked.append(given) or "second", stage)  # type: ignore[func-returns-value]
    assert asked == [(one.item, "stage")]
    assert (one.outcome, one.call.start) == ("second", start)
    assert 5.0 <= one.call.duration < 6.0
    assert one.teardown is again
    one.proceed(lambda *_: "third", stage)
    monkeypatch.setattr(finished_tests, "finish", lambda *_: report())
    one.proceed(lambda *_: "fourth", stage)
    assert one.teardown is again  # a failed teardown stays


def test_a_conclusion_keeps_the_times_of_the_test(item: Any) -> None:
    one = finished(item, lambda: "comparison")
    one.call.start, one.call.stop, one.call.duration = 1.0, 4.0, 3.0
    one.conclude(lambda: Account(("told",)))
    assert one.outcome == Account(("told",))
    assert (one.call.start, one.call.stop, one.call.duration) == (1.0, 4.0, 3.0)


def test_started_and_passed_phases_are_reported(item: Any) -> None:
    started(item)
    assert item.ihook.calls == [
        ("pytest_runtest_logstart", {"nodeid": item.nodeid, "location": item.location})
    ]
    found = passed(item, "setup")
    assert (found.when, found.outcome) == ("setup", "passed")
