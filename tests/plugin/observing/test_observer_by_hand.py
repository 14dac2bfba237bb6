"""The observer of a node, without a writer process, a thread or a ROS."""

from __future__ import annotations

import marshal
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Sensor, Signal
from pytest_tarl.observing import observer as module
from pytest_tarl.observing.observer import Observer
from pytest_tarl.observing.stream import Cut
from pytest_tarl.observing.writer import Rotation

PLACE = Sensor("place", topic="/place", field="x", low=0, high=10, bins=5)
SPEED = Sensor("speed", topic="/speed", field="x", low=0, high=2, bins=2)
MODE = Sensor("mode", topic="/mode", field="x", categories=("auto", "manual"))


class Clock:
    def __init__(self, now: float) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


def message(value: Any) -> Any:
    return SimpleNamespace(x=value)


class Sent:
    """An outlet that keeps the messages; it is full if the test says so."""

    def __init__(self, *given: Any) -> None:
        self.given = given
        self.messages: list[tuple[Any, ...]] = []
        self.full, self.problem, self.pumped, self.closed = False, "", 0, 0

    def put(self, *sent: Any) -> None:
        self.messages.append(sent)

    def pump(self) -> None:
        self.pumped += 1

    def close(self) -> None:
        self.closed += 1

    def kinds(self) -> list[str]:
        return [one[0] for one in self.messages]


class Looks:
    """In place of the lock for which the observer's thread waits: run these, then end."""

    def __init__(self, *before: Callable[[], None]) -> None:
        self.before = [*before]
        self.limits: list[float] = []

    def acquire(self, timeout: float) -> bool:
        self.limits.append(timeout)
        if not self.before:
            return True
        self.before.pop(0)()
        return False


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock(1000.0)
    monkeypatch.setattr(module, "monotonic", made)
    monkeypatch.setattr(module, "time", lambda: made.now + 5e8)
    return made


Observe = Callable[..., tuple[Observer, Sent]]


@pytest.fixture
def observe(monkeypatch: pytest.MonkeyPatch, clock: Clock) -> Observe:
    """Return a function that makes an observer without a thread, and with an outlet that keeps the messages."""
    monkeypatch.setattr(module, "Outlet", Sent)
    monkeypatch.setattr(
        threading, "Thread", lambda **_: SimpleNamespace(start=lambda: None, join=lambda: None)
    )

    def made(*sensors: Sensor, **options: Any) -> tuple[Observer, Sent]:
        one = Observer(sensors, Path("log"), {"node": "n"}, **options)
        sent: Any = one._outlet
        return one, sent

    return made


def test_observer_opens_its_log_with_format_and_rotation(observe: Observe) -> None:
    one, sent = observe(PLACE, rotation=Rotation(9, 2))
    assert sent.given == (Path("log"), {"format": 1, "node": "n"}, Rotation(9, 2))
    assert sent.messages == [("start", 1000.0 + 5e8)]
    assert observe()[1].given[2] == Rotation()
    assert (one.running, one.problem) == (False, "")


def test_step_has_all_sensor_values_and_the_current_cell(observe: Observe) -> None:
    one, sent = observe(PLACE, SPEED)
    one.told(PLACE, message(9.0))
    one.begin()
    one.step(-1.0)  # the cell is unknown until each sensor has a value
    one.told(SPEED, message(0.5))
    one.told(PLACE, message(9.5))  # another value of the same bin
    one.step(0.5)
    one.told(PLACE, message(1.0))
    one.told(PLACE, message(1.5))
    one.step(2.0)
    one.end(passed=True)
    assert sent.kinds() == ["start", "mission", "steps", "end"]
    _, cut, readings, dropped, followed = sent.messages[2]
    found = Cut(*cut)
    assert (found.cells, found.totals) == ([(4, 0), (0, 0)], [-1.0, 0.5, 2.0])
    assert [found.latched[mark] for mark in found.rewards] == [-1, 0, 1]
    assert readings == [9.0, None, 9.5, 0.5, 1.5, 0.5]
    assert (dropped, followed) == (0, None)
    assert sent.messages[3] == ("end", {"passed": True, "failure": "", "time": 1000.0 + 5e8})


def test_unusable_sensor_value_makes_the_cell_unknown(observe: Observe) -> None:
    one, sent = observe(PLACE)
    one.begin()
    for value in (1.0, float("nan"), 3.0, float("nan")):
        one.told(PLACE, message(value))
        one.step(0.0)
    one.end(passed=True)
    cut = Cut(*sent.messages[-2][1])
    assert [cut.latched[mark] for mark in cut.rewards] == [0, -1, 1, -1]


@pytest.mark.parametrize(
    ("told", "problem"),
    [
        (lambda one: one.told(PLACE, SimpleNamespace()), "Sensor 'place': "),
        (lambda one: one.told(PLACE, message("far")), "Sensor 'place': "),
        (lambda one: one.told(SPEED, message(1.0)), "Sensor 'speed': "),
        (lambda one: one.signalled(Signal("tilt", topic="/t", field="x"), SimpleNamespace()), "Signal 'tilt': "),
        (lambda one: one.signalled(Signal("tilt", topic="/t", field="x"), message([1])), "Signal 'tilt': "),
    ],
)  # fmt: skip
def test_sensor_error_is_kept_and_hidden_from_the_node(
    observe: Observe, told: Callable[[Observer], None], problem: str
) -> None:
    one, sent = observe(PLACE, signals=[Signal("tilt", topic="/t", field="x")], following=True)
    one.begin()
    told(one)
    first = one.problem
    assert first.startswith(problem)
    one.told(PLACE, SimpleNamespace())
    assert one.problem == first
    sent.problem = "no space"
    one.close()
    assert one.problem == f"{first}; no space"


def test_new_mission_ends_the_previous_one(observe: Observe, clock: Clock) -> None:
    one, sent = observe(PLACE)
    one.step(5.0)  # before the first mission
    one.begin()
    clock.now += 2.0
    one.step(1.0)
    one.begin()
    one.end(passed=False, failure="fell")
    one.end(passed=True)
    assert sent.kinds() == ["start", "mission", "steps", "end", "mission", "end"]
    assert [one[1]["passed"] for one in sent.messages if one[0] == "end"] == [True, False]
    assert sent.messages[-1][1]["failure"] == "fell"
    assert Cut(*sent.messages[2][1]).totals == [1.0]
    assert not one.running


def test_formula_times_count_from_the_begin(observe: Observe, clock: Clock) -> None:
    tilt = Signal("tilt", topic="/t", field="x")
    one, sent = observe(PLACE, MODE, signals=[tilt], following=True)
    one.signalled(tilt, message(0.25))  # before the mission
    one.begin()
    for delay, value in ((0.5, 1.0), (0.5, 1.0), (1.0, 2.0)):
        clock.now += delay
        one.signalled(tilt, message(value))
        one.told(MODE, message("manual"))  # a category is no number of a formula
        one.step(0.0)
    one._flush()
    clock.now += 1.0
    one.told(PLACE, message(4.0))
    one.end(passed=True)
    assert sent.messages[2][4] == ([0.5, 1.0, 2.0], [[0.5, "tilt", 1.0], [2.0, "tilt", 2.0]])
    end = sent.messages[-1][1]
    assert (end["lasted"], end["changes"]) == (3.0, [[3.0, "place", 4.0]])
    one.begin()
    clock.now += 1.0
    one.signalled(tilt, message(2.0))  # as in the mission before, but received again
    one.end(passed=True)
    assert sent.messages[-1][1]["changes"] == [[1.0, "tilt", 2.0], [0.0, "place", 4.0]]


def test_mission_ends_when_the_node_has_been_idle(observe: Observe, clock: Clock) -> None:
    one, sent = observe(PLACE, idle=10.0)
    one.active()
    one.active()
    assert sent.kinds() == ["start", "mission"]

    def later(seconds: float) -> Callable[[], None]:
        def wait() -> None:
            clock.now += seconds

        return wait

    looks = Looks(later(10.0), later(0.0))
    one._over = looks  # type: ignore[assignment]
    one._look()
    assert one.running
    one.active()  # again at this moment, so that the time counts from now
    one._over = Looks(later(9.0), later(0.5), later(0.6), later(30.0))  # type: ignore[assignment]
    one._look()
    assert sent.kinds() == ["start", "mission", "end"]
    assert sent.messages[-1][1]["passed"] is True
    assert (looks.limits, sent.pumped) == ([module.PERIOD] * 3, 6)
    never, sent = observe(PLACE)
    never.active()
    assert sent.kinds() == ["start"]
    never.begin()
    never._over = Looks(later(1e9))  # type: ignore[assignment]
    never._look()
    assert never.running


def test_records_are_sent_regularly_unless_too_many_bytes_wait(
    observe: Observe, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    one, sent = observe(PLACE)
    one.begin()
    relieved: list[int] = []
    monkeypatch.setattr(one.stream, "relieve", lambda most=None: relieved.append(len(sent.messages)))

    def full() -> None:
        sent.full = True
        one.step(2.0)

    def broken() -> None:
        sent.problem, sent.full = "no space", False

    one._over = Looks(lambda: one.step(1.0), full, broken, lambda: None)  # type: ignore[assignment]
    one._look()
    assert [Cut(*each[1]).totals for each in sent.messages if each[0] == "steps"] == [[1.0], [2.0]]
    assert relieved == [3]
    assert capsys.readouterr().err == "observe: no space\n"


def test_outside_missions_only_new_cells_are_sent(observe: Observe) -> None:
    one, sent = observe(PLACE)
    one.told(PLACE, message(1.0))
    one.step(1.0)
    one._flush()
    one._flush()
    assert sent.messages[1:] == [("cells", [(0,)])]
    assert (one._readings, one._times) == ([], [])


def test_no_events_are_sent_to_a_full_outlet(observe: Observe) -> None:
    one, sent = observe(PLACE)
    one.begin()
    sent.full = True
    for number in range(3):
        one.stream.hook(number, 1.0)
    one.step(1.0)
    one._flush()
    _, cut, _, dropped, _ = sent.messages[-1]
    assert ([entries for entries, _ in Cut(*cut).threads], dropped) == ([[]], 3)
    assert Cut(*cut).totals == [1.0]


class Text(str):
    __slots__ = ()


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        *((one, one) for one in (None, 1.5, 2, True, "auto")),
        (Text("auto"), "auto"),
        (np.float32(0.5), 0.5),
        (np.int64(3), 3.0),
        (np.bool_(True), 1.0),
        ([1.0], None),
        (10**400, 10**400),
        ("1", "1"),
    ],
)
def test_readings_are_sent_as_plain_values(value: Any, expected: Any) -> None:
    found = module._plain(value)
    assert found == expected
    assert type(found) is type(expected)
    marshal.dumps(found)


def test_closing_sends_the_remaining_records(observe: Observe) -> None:
    one, sent = observe(PLACE)
    one.begin()
    one.step(1.0)
    joined: list[bool] = []
    one._thread = SimpleNamespace(join=lambda: joined.append(one._over.locked()))  # type: ignore[assignment]
    one.close()
    assert (joined, sent.closed, sent.kinds()[-1], one.problem) == ([False], 1, "steps", "")
