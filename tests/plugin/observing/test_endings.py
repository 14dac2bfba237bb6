"""Ends of missions, their records in the log, and the changes of signals."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import monotonic, sleep
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl import Sensor, Signal
from pytest_tarl.errors import LogError
from pytest_tarl.instrumentation.importhook import NodeImports
from pytest_tarl.observing import command, outlet
from pytest_tarl.observing.log_format import Record, records
from pytest_tarl.observing.observer import Observer
from pytest_tarl.ros.rclpy.executors import ExternalShutdownException
from pytest_tarl.ros.rospy.exceptions import ROSInterruptException

ABOUT = {"sites": [], "sensors": []}
NO_SITES: Any = SimpleNamespace(positions={}, publishes=frozenset())


def until(true: Callable[[], object]) -> None:
    end = monotonic() + 20
    while not true() and monotonic() < end:
        sleep(0.005)
    assert true()


def ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException | None, **more: Any
) -> tuple[list[Record], BaseException | None]:
    """Run a node that ends with `error`; return the records of its missions and the exception raised."""

    def run(*_: object) -> None:
        if error is not None:
            raise error

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(NodeImports, "run", run)
    observer, raised = Observer([], tmp_path / "log", ABOUT), None
    try:
        command._run(command.Order(Path("node.py"), **more), observer, NO_SITES)
    except BaseException as problem:
        raised = problem
    observer.close()
    return [one for one in records(tmp_path / "log") if one["kind"] != "start"], raised


ENDINGS = [
    (None, True, "", False),
    (SystemExit(), True, None, True),
    (SystemExit(0), True, None, True),
    (SystemExit(3), False, "exit status 3", True),
    (KeyboardInterrupt(), True, "", False),
    (ExternalShutdownException(), True, "", False),
    (ROSInterruptException("rospy shutdown"), True, "", False),
    (ValueError("off the road"), False, "ValueError: off the road", True),
    (GeneratorExit(), False, "GeneratorExit: ", True),
]


@pytest.mark.parametrize(("error", "passed", "failure", "comes_out"), ENDINGS, ids=repr)
def test_a_mission_without_marks_ends_with_the_node(
    error: BaseException | None,
    passed: bool,
    failure: str | None,
    comes_out: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (mission, end), raised = ended(tmp_path, monkeypatch, error)
    assert (mission["kind"], end["kind"], end["passed"]) == ("mission", "end", passed)
    assert failure is None or end["failure"] == failure
    assert (raised is error) is (comes_out or error is None)


def test_sensor_without_a_topic_is_refused_on_a_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = tmp_path / "node.py"
    node.write_text("import rospy\n")
    sensors = (Sensor("place", topic="/place", field="x"), Sensor("speed"))
    fixture = SimpleNamespace(sensors=sensors, test="test_x.py::test_x")
    monkeypatch.setattr(command, "load", lambda _: fixture)
    monkeypatch.setattr(command, "_sites", lambda _: SimpleNamespace(places=()))
    with pytest.raises(LogError, match=r"Sensor 'speed' has no topic\..*Give it a topic"):
        command.observe(command.Order(node, fixture=tmp_path / "f.npz", log=tmp_path / "log", reward="/r"))
    assert not (tmp_path / "log").exists()


@pytest.mark.parametrize("more", [{"mission": "/mission"}, {"idle": 1.0}])
def test_node_start_is_no_mission_if_a_topic_begins_missions(
    more: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ended(tmp_path, monkeypatch, None, **more)[0] == []


def test_begin_and_end_delimit_missions(tmp_path: Path) -> None:
    observer = Observer([], tmp_path / "log", ABOUT)
    for word in ("succeeded", "begin", "rest", "begin", "failed", "failed", "begin", "succeeded"):
        observer.order(word)
    observer.close()
    found = [(one["kind"], one.get("passed"), one.get("failure")) for one in records(tmp_path / "log")][1:]
    begun = ("mission", None, None)
    assert found == [
        *(begun, ("end", True, ""), begun, ("end", False, "reported on the mission topic")),
        *(begun, ("end", True, "")),
    ]


def test_each_change_is_written_once_with_its_time(tmp_path: Path) -> None:
    speed = Signal("speed", topic="/speed", field="x")
    place = Sensor("place", topic="/place", field="x", low=0, high=10, bins=2)
    observer = Observer([place], tmp_path / "log", ABOUT, signals=[speed], following=True)
    observer.begin()
    for value in (1.0, 1.0, 2.0):
        observer.signalled(speed, SimpleNamespace(x=value))
        observer.told(place, SimpleNamespace(x=4 * value))
        observer.step(value)
    observer.end(passed=True)
    observer.begin()
    observer.step(0.0)
    observer.end(passed=True)
    observer.signalled(speed, SimpleNamespace(y=1.0))
    observer.close()
    missions: list[list[list[Any]]] = []
    for one in records(tmp_path / "log"):
        if one["kind"] == "mission":
            missions.append([])
        elif one["kind"] in ("steps", "end"):
            missions[-1] += one["changes"]
    assert [change[1:] for change in missions[0]] == [
        ["speed", 1.0],
        ["place", 4.0],
        ["speed", 2.0],
        ["place", 8.0],
    ]
    assert all(0 <= change[0] < 60 for change in missions[0])
    assert sorted(missions[1]) == [[0.0, "place", 8.0], [0.0, "speed", 2.0]]  # values from before the mission
    assert "Signal 'speed'" in observer.problem


def test_without_formulas_changes_are_not_written(tmp_path: Path) -> None:
    observer = Observer([], tmp_path / "log", ABOUT, signals=[Signal("speed", topic="/speed", field="x")])
    observer.begin()
    observer.signalled(observer.signals[0], SimpleNamespace(x=1.0))
    observer.step(1.0)
    observer.end(passed=True)
    observer.close()
    assert all("changes" not in one for one in records(tmp_path / "log"))


def test_records_that_were_sent_do_not_count_as_waiting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(outlet, "MOST_WAITING", 30_000)
    observer = Observer([], tmp_path / "log", ABOUT)
    observer.begin()
    for number in range(5000):
        observer.stream.hook(0, 1.0)
        observer.step(1.0)
        if number % 500 == 0:
            until(lambda: not observer._outlet._waiting and not observer.stream._rewards)
    assert not observer._outlet.full
    assert observer._outlet._ring._counters[0] > 30_000  # bytes sent
    observer.close()
    assert observer.stream.dropped == 0
