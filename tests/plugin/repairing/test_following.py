"""A constant follows a sensor by a power law through its old value and the value that was found."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import Mutation, form_values
from pytest_tarl.repairing import following as module
from pytest_tarl.repairing.following import following, proportional
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_search import operand

SPEED = Sensor("speed", topic="/odom", field="data", low=0, high=10, bins=10)
LOAD = Sensor("load", topic="/load", field="data", low=0, high=10, bins=10)
NAMED = replace(operand(4, "AHEAD", 1.1), definition=operand(1, "1.1", 1.1).span)
FAST = Guard((Conjunct(SPEED, 3.0, inf),))
FOUR_TIMES = Candidate((Mutation(NAMED, 4.0),), FAST)


@pytest.fixture(autouse=True)
def no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "variables", lambda *_: ())


def order(designed: tuple[int, ...], drifted: tuple[int, ...], *sensors: Sensor) -> Any:
    """Return an order in which each sensor is always in one bin of each world."""

    def world(cell: tuple[int, ...]) -> Any:
        chain = SimpleNamespace(cell=np.zeros(3, int), count=np.full(3, 5.0))
        return SimpleNamespace(cells=[cell], chain=chain)

    return SimpleNamespace(
        root=Path("nowhere"),
        permanent=False,
        comparison=SimpleNamespace(sensors=sensors),
        fixture=SimpleNamespace(sample=world(designed)),
        online=SimpleNamespace(recorded=SimpleNamespace(sample=world(drifted))),
    )


def forms(found: list[Candidate]) -> list[tuple[str, str, dict[str, float]]]:
    made = [(one.mutations[0].form, one.mutations[0]) for one in found]
    return [
        (form.template.name, form.sensor.name, form_values(mutation))
        for form, mutation in made
        if form is not None and form.sensor is not None
    ]


def test_exponent_is_fitted_to_old_and_new_value() -> None:
    # designed 1.5, drifted 6: four times the sensor and four times the constant
    found = list(following(order((1,), (6,), SPEED), FOUR_TIMES))
    assert forms(found) == [("above", "speed", {"power": pytest.approx(0.945, abs=0.01), "usual": 1.5})]
    assert found[0].guard == ALWAYS


def test_inverse_constant_has_a_negative_exponent() -> None:
    smaller = Candidate((Mutation(NAMED, 0.25),), FAST)
    assert forms(list(following(order((1,), (6,), SPEED), smaller)))[0][2]["power"] < 0.0


def test_falling_sensor_scales_only_below_the_designed_value() -> None:
    (found,) = forms(list(following(order((6,), (1,), SPEED), FOUR_TIMES)))
    assert found[0] == "below"
    assert found[2]["power"] == pytest.approx(-0.945, abs=0.01)


def test_the_sensor_of_the_condition_comes_first() -> None:
    found = forms(list(following(order((1, 1), (6, 6), LOAD, SPEED), FOUR_TIMES)))
    assert [name for _, name, _ in found] == ["speed", "load"]


@pytest.mark.parametrize("mutation", [Mutation(NAMED, 1.2), Mutation(NAMED, 1000.0)])
def test_weak_and_extreme_exponents_are_left_out(mutation: Mutation) -> None:
    assert list(following(order((1,), (6,), SPEED), Candidate((mutation,), FAST))) == []


@pytest.mark.parametrize(
    "candidate",
    [
        Candidate((Mutation(NAMED, 4.0), Mutation(operand(5, "2.0", 2.0), 3.0)), FAST),
        Candidate((Mutation(operand(5, "0.0", 0.0), 1.2),), FAST),
        Candidate((Mutation(operand(5, "True", True), value=False),), FAST),
    ],
)
def test_zeros_and_booleans_do_not_follow_a_sensor(candidate: Candidate) -> None:
    assert list(following(order((1,), (6,), SPEED), candidate)) == []


def test_negative_or_constant_sensor_is_not_followed() -> None:
    signed = replace(SPEED, low=-10, high=10)
    assert list(following(order((6,), (9,), signed), FOUR_TIMES)) == []
    assert list(following(order((6,), (6,), SPEED), FOUR_TIMES)) == []


def test_after_a_permanent_change_one_value_suffices() -> None:
    asked = order((1,), (6,), SPEED)
    asked.permanent = True
    assert list(following(asked, FOUR_TIMES)) == []


def test_constant_can_follow_a_node_variable(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "variables", lambda *_: [("self.speed", 1.0, 4.0), ("self.way", 1.0, 9.0)])
    (found,) = following(order((6,), (6,), SPEED), FOUR_TIMES)
    form = found.mutations[0].form
    assert form is not None
    assert (form.template.name, form.variable, form_values(found.mutations[0])["power"]) == (
        "above",
        "self.speed",
        1.0,
    )


def test_a_variable_that_becomes_smaller_is_not_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    # its sign is unknown, and a negative number has no power
    monkeypatch.setattr(module, "variables", lambda *_: [("self.speed", 4.0, 1.0)])
    assert list(following(order((6,), (6,), SPEED), FOUR_TIMES)) == []


def spread(designed: list[int], drifted: list[int], *sensors: Sensor) -> Any:
    """Return an order in which the first sensor visits these bins, each as often."""
    found = order((0,), (0,), *sensors)

    def world(cells: list[int]) -> Any:
        chain = SimpleNamespace(cell=np.arange(len(cells)), count=np.full(len(cells), 5.0))
        return SimpleNamespace(cells=[(cell,) * len(sensors) for cell in cells], chain=chain)

    found.fixture.sample, found.online.recorded.sample = world(designed), world(drifted)
    return found


def test_constant_is_proportional_to_a_varying_sensor() -> None:
    (found,) = proportional(spread([4], [2, 3, 4, 5], SPEED), [NAMED])
    ((mutation),) = found.mutations
    assert form_values(mutation) == {"power": 1.0, "usual": 4.5}
    assert found.guard == ALWAYS


def test_variable_at_the_uses_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "variables", lambda *_: [("distance", 10.0, 11.0), ("floor", 9.0, 9.5)])
    found = list(proportional(spread([4], [2, 3, 4, 5], SPEED), [NAMED]))
    assert [one.mutations[0].form.variable for one in found if one.mutations[0].form] == ["distance", ""]


@pytest.mark.parametrize(
    ("bins", "sensor", "value"),
    [
        ([4], SPEED, 1.1),  # varies no more than designed
        ([2, 3, 4, 5], replace(SPEED, low=-10, high=10), 1.1),  # a power of a negative number
        ([2, 3, 4, 5], SPEED, 0.0),
        ([2, 3, 4, 5], SPEED, True),
    ],
)
def test_other_sensors_and_constants_are_not_proportional(
    bins: list[int], sensor: Sensor, value: float
) -> None:
    assert list(proportional(spread([4], bins, sensor), [replace(NAMED, value=value)])) == []
