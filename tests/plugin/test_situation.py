"""Messages and observations of an episode become bins of sensors and values of signals."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.errors import SettingsError
from pytest_tarl.formulas.marker_arguments import Requirements
from pytest_tarl.formulas.said import Said
from pytest_tarl.formulas.signals import Signal
from pytest_tarl.sensors import Sensor
from pytest_tarl.situation import Situation

X = Sensor("x", topic="/odom", field="data", low=0, high=10, bins=10)
Y = Sensor("y", topic="odom", field=lambda message: message.data * 2, low=0, high=10, bins=10)
WET = Sensor("wet")
MODE = Sensor("mode", categories=("auto", "manual"))
TO_LEARN = Sensor("v", bins=3)
GAP = Signal("gap", topic="/scan", field="data")
FUEL = Signal("fuel")


class Situations:
    """A situation with the cells that it latches and the values that its formulas get."""

    def __init__(self, *sensors: Sensor, signals: tuple[Signal, ...] = (), **given: Any) -> None:
        self.cells: list[Any] = []
        self.given: list[tuple[str, Any]] = []
        formulas: Any = SimpleNamespace(give=lambda name, value: self.given.append((name, value)))
        recorder: Any = SimpleNamespace(latch=self.cells.append)
        self.one = Situation(sensors, Requirements(signals=signals, **given), formulas, recorder)


def said(data: float) -> Any:
    return SimpleNamespace(data=data)


def test_message_sets_all_sensors_of_its_topic() -> None:
    found = Situations(X, Y)
    assert not found.one.begun
    found.one.hear("/odom", said(2.5))
    assert (found.cells, found.one.begun, found.one.known) == ([(2, 5)], True, True)
    found.one.hear("odom", said(1.0))
    found.one.hear("/other", said(9.0))
    assert found.cells == [(2, 5), (1, 2)]
    assert found.given == [("x", 2.5), ("y", 5.0), ("x", 1.0), ("y", 2.0)]


def test_cell_needs_all_sensor_values() -> None:
    found = Situations(X, WET)
    found.one.hear("/odom", said(2.5))
    assert (found.cells, found.one.known) == ([None], False)
    found.one.observe({"wet": True})
    found.one.hear("/odom", said(float("nan")))
    assert (found.cells, found.one.known) == ([None, (2, 1), None], True)


def test_signals_get_values_and_change_no_cell() -> None:
    found = Situations(X, signals=(GAP, FUEL))
    found.one.hear("/scan", said(0.5))
    found.one.observe({"fuel": 3.0})
    assert found.given == [("gap", 0.5), ("fuel", 3.0)]
    assert (found.cells, found.one.begun) == ([], False)
    found.one.observe({"fuel": 2.0, "x": 4.0})
    assert found.cells == [(4,)]


def test_formulas_get_no_category_values() -> None:
    found = Situations(MODE, TO_LEARN)
    found.one.observe({"mode": "manual"})
    found.one.observe({"v": 2})
    found.one.observe({"v": 3.5})
    assert found.given == [("v", 2), ("v", 3.5)]
    assert found.one.values == {"v": [2.0, 3.5]}
    assert all(isinstance(one, float) for one in found.one.values["v"])
    assert found.cells == [None, (1, 0), (1, 0)]


def test_topics_are_named_once_in_order() -> None:
    again = Signal("speed", topic="/odom", field="data")
    assert Situations(WET, X, signals=(GAP, FUEL, again)).one.subscribed == ("/odom", "/scan")
    assert Situations(WET).one.subscribed == ()


@dataclass(slots=True)
class Bool:
    data: float


Bool.__module__ = "std_msgs.msg._bool"


class Plain:
    data = 1.0


class Old(Plain):
    _type = "std_msgs/Bool"


def test_message_types_are_kept_by_topic() -> None:
    found = Situations(X, signals=(GAP,))
    found.one.hear("odom", Bool(1.0))
    found.one.hear("scan", Plain())
    assert found.one.topics == {"/odom": "std_msgs/msg/Bool", "/scan": ""}
    found.one.hear("/scan", Old())
    assert found.one.topics["/scan"].endswith("/msg/Old")


def test_a_situation_without_a_cell_is_explained() -> None:
    found = Situations(X, WET)
    assert "'x' received no message on /odom" in str(found.one.problem())
    found.one.hear("/odom", said(1.0))
    assert "'wet' was never observed: call tarl.observe(wet=…)" in str(found.one.problem())
    found.one.hear("/odom", said(float("nan")))
    found.one.observe({"wet": True})
    assert "Sensor 'x' was NaN whenever the others had values" in str(found.one.problem())
    found.one.hear("/odom", said(1.0))
    found.one.hear("/odom", said(float("nan")))
    assert found.one.problem() is None


def test_missing_field_error_names_sensor_and_type() -> None:
    words = "Sensor 'x': a message on /odom .SimpleNamespace. has no field 'data'"
    with pytest.raises(SettingsError, match=words):
        Situations(X).one.hear("/odom", SimpleNamespace())
    with pytest.raises(SettingsError, match="Signal 'gap': a message on /scan"):
        Situations(signals=(GAP,)).one.hear("/scan", SimpleNamespace())


def observed(name: str, *names: str, followed: bool = True) -> str:
    """Return the error of observing a name in a test that observes some names."""
    found = Situations(WET, signals=(FUEL,), followed=followed, said=Said(observed=names))
    try:
        found.one.observe({name: 1.0})
    except SettingsError as problem:
        return str(problem)
    return ""


def test_misspelt_formula_name_is_refused() -> None:
    assert observed("height", "height") == ""
    assert observed("wett", "wett", "wet") == ""  # the test observes the similar name as well
    assert observed("wett", "wett").endswith("no such sensor or signal: 'wett'; did you mean 'wet'?")
    assert observed("height", "height", followed=False).endswith("'height'; the marker declares wet, fuel.")
    assert observed("height").endswith("the marker declares wet, fuel.")
    assert observed("fule", "fule").endswith("did you mean 'fuel'?")
