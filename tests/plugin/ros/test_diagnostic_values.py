"""Statuses, frequencies and ages of diagnostic_updater, worked out by hand for a given clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from pytest_tarl.ros import message_type
from pytest_tarl.ros.diagnostic_updater import checks
from pytest_tarl.ros.diagnostic_updater.checks import (
    FrequencyStatus,
    FrequencyStatusParam,
    TimeStampStatus,
    TimeStampStatusParam,
)
from pytest_tarl.ros.diagnostic_updater.status import wrapper_of
from pytest_tarl.ros.diagnostic_updater.tasks import (
    CompositeDiagnosticTask,
    DiagnosticTask,
    DiagnosticTaskVector,
    FunctionDiagnosticTask,
)
from pytest_tarl.ros.messages.times import Time
from pytest_tarl.ros.rclpy.time import Time as Time2

At = Callable[[float], None]


@pytest.fixture
def at(monkeypatch: pytest.MonkeyPatch) -> At:
    """Return a function that sets the clock, in seconds."""
    clock = [0.0]
    monkeypatch.setattr(checks, "_now", lambda: clock[0])
    return lambda seconds: clock.__setitem__(0, seconds)


def status(level: int = 0, message: str = "") -> Any:
    made = wrapper_of("ros1")()
    made.summary(level, message)
    return made


def values(made: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in made.values}


@pytest.mark.parametrize(
    ("first", "second", "merged"),
    [
        ((0, "a"), (0, "b"), (0, "a; b")),
        ((0, ""), (0, "b"), (0, "b")),
        ((1, "a"), (2, "b"), (2, "a; b")),
        ((2, "a"), (1, "b"), (2, "a; b")),
        ((1, "a"), (0, "b"), (1, "a")),
        ((0, "a"), (1, "b"), (1, "b")),
        ((1, "a"), (1, "b"), (1, "a; b")),
    ],
)
@pytest.mark.parametrize("kind", ["ros1", "ros2"])
def test_summaries_are_merged(
    kind: Any, first: tuple[int, str], second: tuple[int, str], merged: tuple[int, str]
) -> None:
    one, other = wrapper_of(kind)(), wrapper_of(kind)()
    one.set_level(*first)
    other.set_level(*second)
    copied = wrapper_of(kind)()
    copied.summary(one)
    copied.mergeSummary(other)
    one.mergeSummary(other.level, other.message)
    for found in (one, copied):
        level = found.level if kind == "ros1" else found.level[0]
        assert (level, found.message) == merged
    one.clearSummary()
    assert (one.level, one.message) == (0 if kind == "ros1" else b"\0", "")


def frequency(at: At, ticks: int, seconds: float, tolerance: float = 0.1, **bounds: float) -> Any:
    """Return the status after a number of ticks in a time."""
    at(0.0)
    task = FrequencyStatus(FrequencyStatusParam(bounds, tolerance, 2))
    for _ in range(ticks):
        task.tick()
    at(seconds)
    return task.run(status())


@pytest.mark.parametrize(
    ("ticks", "level", "message"),
    [
        (0, 2, "No events recorded."),
        (8, 1, "Frequency too low."),
        (9, 0, "Desired frequency met"),
        (22, 0, "Desired frequency met"),
        (23, 1, "Frequency too high."),
    ],
)
def test_a_frequency_is_compared_with_bounds_and_tolerance(
    at: At, ticks: int, level: int, message: str
) -> None:
    found = frequency(at, ticks, 2.0, min=5, max=10)  # 4.5 to 11 Hz
    assert (found.level, found.message) == (level, message)
    assert values(found) == {
        "Events in window": str(ticks), "Events since startup": str(ticks), "Duration of window (s)": "2.000000",
        "Actual frequency (Hz)": f"{ticks / 2:f}", "Minimum acceptable frequency (Hz)": "4.500000",
        "Maximum acceptable frequency (Hz)": "11.000000",
    }  # fmt: skip


def test_bounds_that_are_not_given_are_not_shown(at: At) -> None:
    assert "Target frequency (Hz)" in values(frequency(at, 10, 2.0, min=5, max=5))
    found = frequency(at, 999, 2.0, min=0)
    assert found.level == 0
    assert not {"Minimum acceptable frequency (Hz)", "Maximum acceptable frequency (Hz)"} & set(values(found))


@pytest.mark.parametrize(("ticks", "level"), [(0, 2), (3, 1)])
def test_update_at_the_start_has_unlimited_frequency(at: At, ticks: int, level: int) -> None:
    found = frequency(at, ticks, 0.0, min=5, max=10)
    assert (found.level, values(found)["Actual frequency (Hz)"]) == (level, "inf" if ticks else "0.000000")


def test_a_window_begins_at_the_oldest_of_its_updates(at: At) -> None:
    task = FrequencyStatus(FrequencyStatusParam({"min": 1}, 0.1, 2))
    found = []
    for second, ticks in enumerate((4, 2, 6, 0, 0), 1):
        for _ in range(ticks):
            task.tick()
        at(second)
        seen = values(task.run(status()))
        found.append((seen["Events in window"], seen["Duration of window (s)"], seen["Events since startup"]))
    assert found == [
        ("4", "1.000000", "4"), ("6", "2.000000", "6"), ("8", "2.000000", "12"), ("6", "2.000000", "12"),
        ("0", "2.000000", "12"),
    ]  # fmt: skip
    task.clear()
    at(7)
    assert values(task.run(status()))["Events since startup"] == "0"


@pytest.mark.parametrize(
    ("stamps", "level", "message", "counts"),
    [
        ([], 1, "No data since last update.", "000"),
        ([10.0, 9.0], 0, "Timestamps are reasonable.", "000"),
        ([11.0, 5.0], 0, "Timestamps are reasonable.", "000"),
        ([11.5], 2, "Timestamps too far in future seen.", "100"),
        ([4.5], 2, "Timestamps too far in past seen.", "010"),
        ([4.5, 11.5], 2, "Timestamps too far in past seen.", "110"),
        ([0.0, 9.0], 2, "Zero timestamp seen.", "001"),
        ([0.0], 1, "No data since last update.", "000"),
    ],
)
def test_the_ages_of_stamps_are_compared_with_bounds(
    at: At, stamps: list[float], level: int, message: str, counts: str
) -> None:
    task = TimeStampStatus(TimeStampStatusParam(-1, 5))
    at(10.0)
    for stamp in stamps:
        task.tick(stamp)
    found = task.run(status())
    assert (found.level, found.message) == (level, message)
    names = (
        "Early diagnostic update count:",
        "Late diagnostic update count:",
        "Zero seen diagnostic update count:",
    )
    assert "".join(values(found)[name] for name in names) == counts
    ages = [10.0 - stamp for stamp in stamps if stamp] or [0.0]
    assert values(found)["Earliest timestamp delay:"] == f"{min(ages):f}"
    assert values(found)["Latest timestamp delay:"] == f"{max(ages):f}"
    again = task.run(status())
    assert again.message == "No data since last update."


def test_stamps_of_ros1_and_ros2_are_read(at: At) -> None:
    task = TimeStampStatus()
    at(10.0)
    message: Any = message_type("builtin_interfaces/msg/Time")(sec=7, nanosec=500_000_000)
    for stamp in (Time(8), Time2(seconds=9), message, 6):
        task.tick(stamp)
    assert task._ages == [2.0, 1.0, 2.5, 4.0]
    assert (task.params.min_acceptable, task.params.max_acceptable) == (-1, 5)


def test_composite_tasks_are_merged() -> None:
    seen = []

    def fill(level: int, message: str) -> FunctionDiagnosticTask:
        def run(stat: Any) -> Any:
            seen.append((stat.level, stat.message))
            stat.summary(level, message)
            return stat

        return FunctionDiagnosticTask(message, run)

    both = CompositeDiagnosticTask("both")
    for task in (fill(0, "fine"), fill(1, "warm"), fill(2, "broken")):
        both.addTask(task)
    found = both.run(status(1, "before"))
    assert (found.level, found.message, both.getName()) == (2, "warm; broken", "both")
    assert seen == [(1, "before")] * 3
    assert DiagnosticTask("none").run(found) is found


def test_tasks_are_added_named_and_removed() -> None:
    added: list[str] = []

    class Tasks(DiagnosticTaskVector):
        def addedTaskCallback(self, task: Any) -> None:  # noqa: N802 (the library's name)
            added.append(task.name)

    tasks = Tasks()
    tasks.add("motor", lambda stat: stat)
    tasks.add(checks.Heartbeat())
    tasks.add("motor", lambda stat: None)
    assert added == ["motor", "Heartbeat", "motor"]
    beat = status(2, "x")
    tasks.tasks[1].run(beat)
    assert (beat.name, beat.level, beat.message) == ("Heartbeat", 0, "Alive")
    assert [tasks.removeByName(name) for name in ("motor", "pump")] == [True, False]
    assert [task.name for task in tasks.tasks] == ["Heartbeat", "motor"]
