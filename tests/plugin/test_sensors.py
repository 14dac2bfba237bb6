"""Sensors: bins of values, names of bins, and messages for invalid declarations."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.errors import RecordingError, SettingsError
from pytest_tarl.learning.binning import learned_edges
from pytest_tarl.sensors import declared, reading, stored, with_edges

X = Sensor("x", topic="/odom", field="pose.x", low=-1.0, high=3.0, bins=8, unit="m")


@given(st.floats(-10, 10))
def test_a_value_lies_in_the_interval_of_its_bin(value: float) -> None:
    index = X.bin(value)
    assert index is not None
    low, high = X.interval(index, index)
    assert low - 1e-9 <= value <= high + 1e-9


@pytest.mark.parametrize(
    ("value", "index"), [(-1.0, 0), (-0.5, 1), (3.0, 7), (3.0001, 8), (-1.1, -1), (math.inf, 8)]
)
def test_edge_belongs_to_the_bin_above(value: float, index: int) -> None:
    assert X.bin(value) == index


def test_nan_has_no_bin() -> None:
    assert X.bin(math.nan) is None


def test_booleans_integers_and_categories_need_no_bins() -> None:
    assert [Sensor("terrain").bin(value) for value in (False, True, 7)] == [0, 1, 7]
    assert Sensor("mode", categories=("dry", "wet")).bin("wet") == 1


@pytest.mark.parametrize("expr", ["speed", "self.heading", "self.state['yaw'].value", "a.b[0]"])
def test_condition_reads_the_variable_of_the_sensor(expr: str) -> None:
    assert not Sensor("x").guardable
    assert Sensor("x", expr=expr).guardable
    assert Sensor("x", expr=expr).path == ""


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"name": "not a name"}, "not a Python identifier"),
        ({"name": "x", "topic": "/odom"}, "topic or a field but not both"),
        ({"name": "x", "low": 0.0, "bins": 3}, "low, high and bins together"),
        ({"name": "x", "low": 2.0, "high": 1.0, "bins": 3}, "low must be below high"),
        ({"name": "x", "low": 0.0, "high": 1.0, "bins": 0}, "bins a whole number of at least 1"),
        (
            {"name": "x", "low": 0.0, "high": 1.0, "bins": 2, "categories": ("a",)},
            "both a numeric range and categories",
        ),
        ({"name": 5}, "not a Python identifier"),
        ({"name": "x", "low": "a", "high": 1.0, "bins": 2}, "both finite"),
        ({"name": "x", "low": 0.0, "high": float("nan"), "bins": 2}, "both finite"),
        ({"name": "x", "low": 0.0, "high": 1.0, "bins": 2.0}, "bins a whole number of at least 1"),
        ({"name": "x", "low": 0.0, "high": 1.0, "bins": True}, "bins a whole number of at least 1"),
        ({"name": "x", "topic": 5, "field": "data"}, "topic must be a string"),
        ({"name": "x", "topic": "/odom", "field": ""}, "field must be a string"),
        ({"name": "x", "expr": "min(ranges)"}, "expr must name a variable of the node"),
        ({"name": "x", "expr": "ranges[i]"}, "expr must name a variable of the node"),
        ({"name": "x", "expr": "a b"}, "expr must name a variable of the node"),
        ({"name": "x", "expr": 5}, "expr must name a variable of the node"),
        ({"name": "x", "categories": "auto"}, "categories lists the strings"),
        ({"name": "x", "categories": (False, True)}, "Booleans and small integers need no categories"),
        ({"name": "x", "categories": ["auto", "auto"]}, "'auto' twice"),
    ],
)
def test_an_invalid_declaration_is_reported_in_one_sentence(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        Sensor(**arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [0.5, "wet"])
def test_a_measurement_needs_bins_and_a_string_needs_categories(value: object) -> None:
    with pytest.raises(SettingsError, match=r"low, high and bins for a measurement"):
        Sensor("x").bin(value)


@pytest.mark.parametrize("value", ["wet", None, [1.0], np.array([1.0, 2.0])])
def test_a_value_that_is_not_a_number_is_reported(value: object) -> None:
    with pytest.raises(SettingsError, match=r"'x' got .* is not a number"):
        Sensor("x", low=0, high=1, bins=2).bin(value)


@pytest.mark.parametrize("value", [1, True, np.float32(1.0), np.array(1.0), Fraction(1)])
def test_numbers_of_any_type_have_a_bin(value: object) -> None:
    assert Sensor("x", low=0, high=2, bins=2).bin(value) == 1


def test_huge_number_is_outside_the_range() -> None:
    assert Sensor("x", low=0, high=1, bins=2).bin(10**400) == 2
    assert Sensor("x", low=0, high=1, bins=2).bin(-(10**400)) == -1


def test_categories_may_be_a_list() -> None:
    assert Sensor("mode", categories=["dry", "wet"]) == Sensor("mode", categories=("dry", "wet"))  # type: ignore[arg-type]


def test_an_unknown_category_is_reported() -> None:
    with pytest.raises(SettingsError, match=r"'icy'.*'dry', 'wet'"):
        Sensor("mode", categories=("dry", "wet")).bin("icy")


def test_bins_have_readable_names() -> None:
    assert X.label(2) == "0-0.5 m"
    assert Sensor("mode", categories=("dry", "wet")).label(1) == "wet"


def test_rounding_never_moves_a_value_outside_the_range() -> None:
    sensor = Sensor("x", low=-3.7, high=3.9, bins=5)
    below = math.nextafter(3.9, 0.0)
    assert sensor.bin(below) == sensor.bin(3.9) == 4
    assert sensor.bin(math.nextafter(3.9, 5.0)) == 5


@pytest.mark.parametrize("bounds", [(-math.inf, 1.0, 3), (0.0, math.inf, 3), (0.0, 1.0, 2.5)])
def test_infinite_bounds_and_fractions_of_bins_are_refused(bounds: tuple[float, float, int]) -> None:
    low, high, bins = bounds
    with pytest.raises(SettingsError, match="finite"):
        Sensor("x", low=low, high=high, bins=bins)


HEADING = Sensor("heading", topic="/pose", field="theta", bins=8, angle=True, unit="rad")


@given(st.floats(-20, 20), st.integers(-3, 3))
def test_angle_bin_ignores_full_turns(value: float, turns: int) -> None:
    index = HEADING.bin(value)
    assert index is not None
    assert 0 <= index < 8
    turned = HEADING.bin(value + turns * 2 * math.pi)
    assert turned is not None
    assert (index - turned) % 8 in (0, 1, 7)  # on a bin edge, rounding decides


def test_angle_interval_may_cross_the_range_end() -> None:
    low, high = HEADING.interval(7, 8)
    assert (low, high) == pytest.approx((0.75 * math.pi, -0.75 * math.pi))
    assert HEADING.interval(3, 10) == (-math.inf, math.inf)


def test_unequal_bins_contain_the_values_between_their_edges() -> None:
    sensor = Sensor("x", edges=(0.0, 1.0, 5.0, 6.0))
    assert [sensor.bin(value) for value in (-1, 0, 0.5, 1, 4.9, 5, 6, 7)] == [-1, 0, 0, 1, 1, 2, 2, 3]
    assert sensor.interval(1, 1) == (1.0, 5.0)
    assert sensor.resolution == 1.0


def test_learned_bins_contain_similar_numbers_of_values() -> None:
    asked = Sensor("x", topic="/x", field="data", bins=4)
    values = (np.random.default_rng(0).normal(size=4000) ** 3).tolist()
    (found,) = with_edges((asked,), learned_edges((asked,), {"x": values}))
    counts = np.bincount([index for value in values if 0 <= (index := found.bin(value) or 0) < 4])
    assert counts == pytest.approx(1000, abs=80)
    assert declared(found) == asked


def test_bins_cannot_be_learned_from_a_constant() -> None:
    with pytest.raises(RecordingError, match="'x' read 2 all the time"):
        learned_edges((Sensor("x", bins=4),), {"x": [2.0, 2.0, math.nan]})


def test_function_sensor_is_never_in_a_condition() -> None:
    def nearest(scan: SimpleNamespace) -> float:
        return float(min(scan.ranges))

    sensor = Sensor("near", topic="/scan", field=nearest, low=0, high=4, bins=8)
    assert reading(SimpleNamespace(ranges=[3.0, 0.6]), nearest) == 0.6
    assert str(stored(sensor).field).endswith("nearest()")
    assert not sensor.guardable
    assert not stored(sensor).guardable


def test_a_single_edge_is_a_threshold() -> None:
    flag = Sensor("loaded", topic="/loaded", field="data", edges=(0.5,))
    assert [flag.bin(value) for value in (-1e9, 0, 0.49, 0.5, 1.0, True)] == [-1, -1, -1, 0, 0, 0]
    assert flag.interval(-1, -1) == (-math.inf, 0.5)
    assert flag.interval(0, 0) == (0.5, math.inf)
    assert Sensor(**dataclasses.asdict(flag)) == flag


@pytest.mark.parametrize(
    "wrong", [{"edges": (0.5,), "angle": True}, {"edges": (0.5,), "tilings": 2}, {"edges": ("x",)}]
)
def test_invalid_edges_are_reported_in_one_sentence(wrong: dict[str, Any]) -> None:
    with pytest.raises(SettingsError, match=r"edges must be|tilings must be"):
        Sensor("x", **wrong)


def test_a_field_may_be_indexed_as_in_python() -> None:
    assert Sensor("ahead", topic="/scan", field="ranges[2]") == Sensor(
        "ahead", topic="/scan", field="ranges.2"
    )
