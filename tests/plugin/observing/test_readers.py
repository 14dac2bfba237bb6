"""The fast functions that read and bin the values of a sensor give the results of the general ones."""

from __future__ import annotations

import math
from collections import UserDict
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.errors import TarlError
from pytest_tarl.observing.readers import binner, reader
from pytest_tarl.sensors import reading

SENSORS = [
    Sensor("uniform", low=-1.0, high=2.0, bins=7),
    Sensor("narrow", low=0.1, high=0.1 + 1e-9, bins=3),
    Sensor("edges", edges=(-1.0, 0.25, 0.5, 7.0)),
    Sensor("single", edges=(0.5,)),
    Sensor("angle", angle=True, bins=8),
    Sensor("bearing", angle=True, low=0.0, high=360.0, bins=5),
    Sensor("uneven", angle=True, edges=(-3.0, 0.0, 0.1, 3.0)),
    Sensor("to_learn", bins=4),
    Sensor("whole"),
    Sensor("mode", categories=("auto", "manual")),
]
VALUES = (
    st.floats()
    | st.integers()
    | st.booleans()
    | st.sampled_from([0.1, 2.0, -1.0, 0.25, 0.5, 7.0, math.pi, -math.pi, 360.0, -1e-20, 0.1 + 1e-9])
    | st.sampled_from(["auto", "off", None, np.float32(0.3), np.int64(3), np.bool_(True), [1.0], 2**60 + 1])
)


def outcome(function: Any, value: Any) -> Any:
    try:
        return function(value)
    except (TarlError, AttributeError, LookupError, TypeError, ValueError) as error:
        return type(error), str(error)


@pytest.mark.parametrize("sensor", SENSORS, ids=lambda sensor: sensor.name)
@given(value=VALUES)
@example(value=-1e-20)
@example(value=math.nextafter(2.0, 0.0))
@example(value=2**53 + 1)
def test_a_reader_gives_the_bins_of_its_sensor(sensor: Sensor, value: Any) -> None:
    assert outcome(binner(sensor), value) == outcome(sensor.bin, value)


def message(**fields: Any) -> SimpleNamespace:
    return SimpleNamespace(**fields)


CASES = [
    ("x", [message(x=1.0), message(x=2.0), {"x": 3.0}, message(x=None), UserDict(x=4.0), message(y=1.0)]),
    ("pose.x", [message(pose=message(x=1.0)), message(pose={"x": 2.0}), message(pose=None), {"pose": {}}]),
    ("items", [{"items": 1.0}, message(items=2.0), {}]),
    ("ranges.0", [message(ranges=[1.0, 2.0]), message(ranges=[]), message(ranges={"0": 5.0})]),
    ("ranges.-1", [message(ranges=[1.0, 2.0])]),
    ("", [message(x=1.0)]),
    (lambda one: one.x + 1, [message(x=1.0), message()]),
]


@pytest.mark.parametrize(("field", "messages"), CASES, ids=lambda case: str(case)[:9])
def test_observed_fields_are_read_as_in_a_test(field: Any, messages: list[Any]) -> None:
    read = reader(field)
    for one in [*messages, *messages]:
        found, wanted = outcome(read, one), outcome(lambda each: reading(each, field), one)
        assert found == wanted


def test_computed_properties_are_read_each_time() -> None:
    class Made:
        count = 0

        @property
        def x(self) -> float:
            self.count += 1
            return float(self.count)

    one, read = Made(), reader("x")
    found = [read(one) for _ in range(5)]
    assert found == sorted(set(found))
