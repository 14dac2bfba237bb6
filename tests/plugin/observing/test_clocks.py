"""With jumping clocks and suspended machines, missions keep their steps and order."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import pytest

from pytest_tarl import Sensor
from pytest_tarl.observing import observer as observing
from pytest_tarl.observing.log_format import records
from pytest_tarl.observing.observer import Observer
from pytest_tarl.observing.writer import unpacked

YEAR = 365 * 86400.0


class Clock:
    def __init__(self, now: float) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize("jump", [-YEAR, YEAR, -1e10])
def test_clock_jump_changes_only_dates(jump: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wall = Clock(1.7e9)
    monkeypatch.setattr(observing, "time", wall)
    observer = Observer([Sensor("x")], tmp_path / "log", {"sites": [], "sensors": ["x"]}, following=True)
    for mission in range(3):
        observer.begin()
        for step in range(50):
            if (mission, step) == (1, 20):
                wall.now += jump
            observer.step(100.0 * mission + step)
        observer.end(passed=mission != 1)
    observer.close()
    found = list(records(tmp_path / "log"))
    assert [one["passed"] for one in found if one["kind"] == "end"] == [True, False, True]
    steps = [one for one in found if one["kind"] == "steps"]
    rewards = list(chain.from_iterable(unpacked(one["reward"], "float64").tolist() for one in steps))
    assert rewards == [100.0 * mission + step for mission in range(3) for step in range(50)]
    times = list(chain.from_iterable(one["times"] for one in steps))
    assert all(0 <= time < 60 for time in times)


@pytest.mark.parametrize("asleep", [5.0, 8 * 3600.0])
def test_long_pause_begins_a_new_mission_without_losing_steps(
    asleep: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = Clock(1000.0)
    monkeypatch.setattr(observing, "monotonic", clock)
    observer = Observer([], tmp_path / "log", {"sites": [], "sensors": []}, idle=60.0)
    for number in range(100):
        if number == 50:
            clock.now += asleep
            if asleep > 60.0:
                while observer.running:
                    pass
        observer.active()
        observer.step(float(number))
        clock.now += 0.01
    observer.end(passed=True)
    observer.close()
    found = list(records(tmp_path / "log"))
    kinds = [one["kind"] for one in found if one["kind"] != "steps"]
    assert kinds == ["start", *["mission", "end"] * (2 if asleep > 60 else 1)]
    assert all(one["passed"] for one in found if one["kind"] == "end")
    rewards = [unpacked(one["reward"], "float64").tolist() for one in found if one["kind"] == "steps"]
    assert list(chain.from_iterable(rewards)) == [float(number) for number in range(100)]


def test_nothing_is_recorded_between_missions(tmp_path: Path) -> None:
    observer = Observer([Sensor("x")], tmp_path / "log", {"sites": [], "sensors": ["x"]})
    observer.begin()
    observer.step(1.0)
    observer.end(passed=True)
    for number in range(5000):  # the node continues and no other mission begins
        observer.stream.hook(0, 1.0)
        observer.step(float(number))
    observer._flush()
    assert held(observer) == 0
    observer.begin()
    observer.step(2.0)
    observer.close()
    steps = [one for one in records(tmp_path / "log") if one["kind"] == "steps"]
    assert [unpacked(one["reward"], "float64").tolist() for one in steps] == [[1.0], [2.0]]


def held(observer: Observer) -> int:
    """Return the number of entries that wait in the node's process."""
    events = sum(len(buffer.entries) for buffer in observer.stream._buffers)
    return events + len(observer._times) + len(observer._readings) + len(observer._changes)
