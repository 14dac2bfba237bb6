from __future__ import annotations

import gc
import math
import weakref
from array import array
from collections import OrderedDict, deque
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.instrumentation import magnitude as magnitudes
from pytest_tarl.instrumentation.magnitude import LIMIT, SAMPLE, magnitude


class Vector3:
    """A message with slots, like those of rospy."""

    __slots__ = ("x", "y", "z")
    _slot_types = ("float64", "float64", "float64")

    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z


class Header:
    __slots__ = ("frame_id", "seq", "stamp")

    def __init__(self):
        self.seq, self.stamp, self.frame_id = 9, SimpleNamespace(secs=4), "map"


class Stamped:
    __slots__ = ("header", "orientation_covariance", "vector")

    def __init__(self):
        self.header, self.vector, self.orientation_covariance = Header(), Vector3(3.0, 4.0, 0.0), [1e3] * 9


class Point:
    """A message like those of rclpy: properties with checks, over slots that begin with an underscore."""

    __slots__ = ("_x", "_y")

    @classmethod
    def get_fields_and_field_types(cls):
        return {"x": "double", "y": "double"}

    def __init__(self, x, y):
        self._x, self._y = x, y

    @property
    def x(self):
        raise AssertionError("a property of the program must not run")

    y = x


@dataclass
class Pose:
    position: Vector3
    heading: float


@pytest.mark.parametrize(
    ("value", "size"),
    [
        (-2.5, 2.5),
        (-3, 3.0),
        (True, 1.0),
        (False, 0.0),
        (None, 0.0),
        ("7", 0.0),
        (b"\x01", 0.0),
        (3 + 4j, 5.0),
        (Fraction(-1, 2), 0.5),
        (Decimal("1.5"), 1.5),
        (np.float32(1.5), 1.5),
        (np.bool_(True), 1.0),
        (np.array([[3, 4]]), 5.0),
        (np.array([3j, 4]), 5.0),
        (np.array([]), 0.0),
        (np.array(["a"]), 0.0),
        (array("d", [3.0, 4.0]), 5.0),
        (array("B", [3, 4]), 5.0),
        ([3, 4.0], 5.0),
        ((3, [4, "x", None]), 5.0),
        ({"a": 3, "b": {"c": 4}}, 5.0),
        (OrderedDict(a=2.0), 2.0),
        (deque([3.0, 4.0]), 5.0),
        ({-2.0}, 2.0),
        ([], 0.0),
        (Vector3(1.0, 2.0, 2.0), 3.0),
        (Stamped(), 5.0),
        (Point(3.0, 4.0), 5.0),
        (Pose(Vector3(0, 0, 3), 4.0), 5.0),
        (object(), 0.0),
        (SimpleNamespace(x=3.0), 0.0),
        (Vector3, 0.0),
    ],
)
def test_each_value_has_the_expected_magnitude(value, size):
    assert magnitude(value) == pytest.approx(size)


@pytest.mark.parametrize(
    "nothing", [math.nan, math.inf, -math.inf, np.float64("inf"), Decimal("sNaN"), complex("nan")]
)
def test_nan_and_infinity_count_as_zero(nothing):
    assert magnitude(nothing) == 0.0
    assert magnitude([nothing, 3.0, 4]) == pytest.approx(5.0)
    assert magnitude({"range": nothing, "angle": 2.0}) == pytest.approx(2.0)


def test_nan_and_infinity_in_arrays_count_as_0():
    assert magnitude(np.array([np.inf, 3.0, np.nan, 4.0])) == pytest.approx(5.0)
    assert magnitude(array("d", [math.inf, 2.0])) == pytest.approx(2.0)


@pytest.mark.parametrize(
    "huge", [10**400, -(10**400), 1e300, [1e308] * 9, [10**400], np.full(9, 1e300), 1e300j]
)
def test_huge_values_stay_below_the_limit(huge):
    assert magnitude(huge) == LIMIT


def test_cyclic_containers_terminate():
    ring: list[object] = [3.0]
    ring.append(ring)
    table: dict[str, object] = {"v": 4.0, "ring": ring}
    table["self"] = table
    assert magnitude(table) == 5.0


def test_deep_nesting_terminates():
    deep: object = 1.0
    for _ in range(100_000):
        deep = [deep]
    assert magnitude(deep) == 0.0


@pytest.mark.parametrize("make", [list, tuple, np.array])
def test_long_sequences_are_sampled_and_scaled(make):
    assert magnitude(make([2.0] * (20 * SAMPLE))) == pytest.approx(2.0 * math.sqrt(20 * SAMPLE))


class Refusing:
    """An object whose special methods all raise."""

    def __getattribute__(self, name):
        raise RuntimeError(name)

    __float__ = __iter__ = __len__ = __abs__ = __eq__ = lambda *_: 1 / 0
    __hash__ = None


noticed: list[str] = []


class Moody(type):
    def __hash__(cls):
        raise RuntimeError("no hash")

    def __eq__(cls, other):
        raise RuntimeError("no comparison")

    def __getattribute__(cls, name):
        noticed.append(name)
        return super().__getattribute__(name)

    @property
    def __dict__(cls):
        raise RuntimeError("no attributes")


class OfMoodyClass(metaclass=Moody):
    __slots__ = ("x", "y")


class Numbers(list):
    def __iter__(self):
        raise AssertionError("must not run")


class Count(int):
    def __float__(self):
        raise AssertionError("must not run")


def test_objects_that_raise_have_magnitude_0():
    assert magnitude(Refusing()) == 0.0
    assert magnitude([Refusing(), 2.0]) == 2.0
    moody = OfMoodyClass()
    moody.x, moody.y = 3.0, 4.0
    noticed.clear()
    assert magnitude([moody]) == 5.0
    assert noticed == []


def test_methods_of_subclasses_do_not_run():
    assert magnitude(Numbers([3.0, 4.0])) == 5.0
    assert magnitude(Count(7)) == 7.0


@pytest.mark.parametrize("slots", [("x", "y"), ("x",), ()])
def test_the_cache_does_not_keep_classes_alive(slots):
    kind = type("Message", (), {"__slots__": (*slots, "__weakref__"), "x" if "x" not in slots else "z": 1.0})
    magnitude(kind())
    gone = weakref.ref(kind)
    del kind
    gc.collect()
    assert gone() is None


def test_a_mock_records_no_access():
    mock = MagicMock()
    assert magnitude(mock) == 0.0
    assert mock.mock_calls == []


ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.complex_numbers()
    | st.fractions(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
    max_leaves=20,
)


@given(ANYTHING)
def test_magnitudes_are_finite_and_not_negative(value):
    size = magnitude(value)
    assert type(size) is float
    assert 0.0 <= size <= LIMIT


@given(st.lists(st.floats(-1e6, 1e6)))
def test_lists_arrays_and_nested_lists_have_the_same_magnitude(numbers):
    assert magnitude(numbers) == pytest.approx(magnitude(np.array(numbers)))
    assert magnitude([[one] for one in numbers]) == pytest.approx(magnitude(numbers))


def test_the_number_of_known_classes_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(magnitudes, "_KINDS", {})
    monkeypatch.setattr(magnitudes, "_KINDS_KEPT", 3)
    kinds = [type(f"Kind{number}", (), {}) for number in range(8)]
    for kind in kinds:
        assert magnitude(kind()) == 0.0
        assert len(magnitudes._KINDS) <= 3
