"""The channel of each fault without a node: the arrivals of messages, from given random numbers."""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl import faults
from pytest_tarl.errors import SettingsError
from pytest_tarl.faults.installing import Faults
from pytest_tarl.faults.message_numbers import altered, store
from pytest_tarl.faults.topic import moment, sizes, up_to
from pytest_tarl.ros import message_type
from pytest_tarl.spaces import Choice, Span

Vector3 = message_type("geometry_msgs/Vector3")
Odometry = message_type("nav_msgs/Odometry")


class Draws:
    """Stand-in for a random generator: the given numbers in turn."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = list(numbers)
        self.scales: list[tuple[float, float]] = []

    def random(self) -> float:
        return self.numbers.pop(0)

    def normal(self, mean: float, deviation: float) -> float:
        self.scales.append((mean, deviation))
        return self.numbers.pop(0)


def arrivals(
    fault: Any, size: float, sent: Sequence[tuple[float, Any]], *numbers: float
) -> list[list[tuple[float, Any]]]:
    """Return the arrivals of each (time in s, message)."""
    channel = fault.begin(size, Draws(*numbers))
    return [[(round(delay, 9), one) for delay, one in channel(message, time)] for time, message in sent]


SENT = [(0.0, "a"), (1.0, "b"), (2.0, "c"), (3.0, "d")]


def test_message_is_lost_with_the_given_probability() -> None:
    found = arrivals(faults.dropout("/t", 1.0), 0.5, SENT, 0.49, 0.5, 0.51, 0.0)
    assert found == [[], [(0.0, "b")], [(0.0, "c")], []]


def test_message_arrives_twice_with_the_given_probability() -> None:
    found = arrivals(faults.duplicates("/t", 1.0), 0.5, SENT, 0.49, 0.5, 0.51, 0.0)
    assert [len(one) for one in found] == [2, 1, 1, 2]
    assert found[0] == [(0.0, "a"), (0.0, "a")]


def test_reordered_message_waits_for_its_successor() -> None:
    found = arrivals(faults.reordering("/t", 1.0), 0.5, SENT, 0.49, 0.5, 0.3)
    assert found == [[], [(0.0, "b"), (0.0, "a")], [(0.0, "c")], []]


def test_frozen_topic_repeats_its_last_value() -> None:
    found = arrivals(faults.freeze("/t", 9.0, at=1.0), 2.0, SENT)
    assert found == [[(0.0, "a")], [(0.0, "a")], [(0.0, "a")], [(0.0, "d")]]
    assert arrivals(faults.freeze("/t", 9.0, at=0.5), 1.0, SENT)[1:3] == [[(0.0, "a")], [(0.0, "c")]]
    assert arrivals(faults.freeze("/t", 9.0), 2.5, SENT[1:]) == [[(0.0, "b")], [(0.0, "b")], [(0.0, "d")]]


def test_messages_are_delayed_by_the_fault_size() -> None:
    assert arrivals(faults.latency("/t", 9.0), 0.25, SENT[:2]) == [[(0.25, "a")], [(0.25, "b")]]


def test_varying_delays_keep_the_message_order() -> None:
    found = arrivals(faults.jitter("/t", 9.0), 4.0, SENT, 0.75, 0.25, 0.5, 0.0)
    # a arrives at 0 + 3; b would at 1 + 1 but waits for a; c at 2 + 2; d would at 3 + 0 but waits for c
    assert found == [[(3.0, "a")], [(2.0, "b")], [(2.0, "c")], [(1.0, "d")]]


def test_noise_is_added_from_a_centred_normal_distribution() -> None:
    draws = Draws(0.5, -0.25)
    channel = faults.noise("/t", "x", 1.0).begin(0.1, draws)  # type: ignore[arg-type]
    ((delay, message),) = channel(Vector3(x=1.0, y=2.0), 0.0)
    ((_, second),) = channel(message, 0.0)
    assert (delay, message.x, message.y, second.x) == (0.0, 1.5, 2.0, 1.25)
    assert draws.scales == [(0.0, 0.1)] * 2


@pytest.mark.parametrize(
    ("fault", "size", "value", "expected"),
    [
        (faults.bias("/t", "x", -1, 1), 0.5, 2.0, 2.5),
        (faults.scale("/t", "x", 0, 3), 3.0, 2.0, 6.0),
        (faults.sign("/t", "x"), True, 2.0, -2.0),
        (faults.quantisation("/t", "x", 1), 0.5, 1.7, 1.5),
        (faults.quantisation("/t", "x", 1), 0.5, -1.8, -2.0),
        (faults.quantisation("/t", "x", 1), 0.5, math.inf, math.inf),
    ],
)
def test_field_fault_changes_a_copy(fault: Any, size: float, value: float, expected: float) -> None:
    sent = Vector3(x=value, y=value)
    ((delay, message),) = fault.begin(size, Draws())(sent, 5.0)
    assert (delay, message.x, message.y, sent.x) == (0.0, expected, value, value)


def test_nan_is_not_rounded() -> None:
    ((_, message),) = faults.quantisation("/t", "x", 1).begin(0.5, Draws())(Vector3(x=math.nan), 0.0)  # type: ignore[arg-type]
    assert math.isnan(message.x)


def test_swapped_fields_are_exchanged_in_a_copy() -> None:
    sent = Vector3(x=1.0, y=2.0, z=3.0)
    ((delay, message),) = faults.swapped("/t", "x", "z").begin(1.0, Draws())(sent, 0.0)  # type: ignore[arg-type]
    assert (delay, message.x, message.y, message.z, sent.x) == (0.0, 3.0, 2.0, 1.0, 1.0)
    assert faults.swapped("/t", "x", "z").field == "x, z"


def test_sequence_element_of_a_message_is_changed() -> None:
    odometry = Odometry()
    changed = altered(odometry, "pose.covariance.7", lambda x: x + 2.0)
    assert [changed.pose.covariance[at] for at in (6, 7, 8)] == [0.0, 2.0, 0.0]
    changed = altered(changed, "pose.pose.position.x", lambda x: x + 1.0)
    assert (changed.pose.pose.position.x, odometry.pose.pose.position.x) == (1.0, 0.0)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (3, 5),  # 4.6
        (2, 3),
        (-3, -4),
        (1.0, 1.5),
        ([1, 2.0], [2, 3.0]),
        ((2, 4.0), (3, 6.0)),
        ([[2.0], [4.0]], [[3.0], [6.0]]),
    ],
)
def test_each_number_is_changed_and_whole_numbers_stay_whole(value: Any, expected: Any) -> None:
    found = altered(SimpleNamespace(x=value), "x", lambda x: 1.5 * x + (0.1 if x == 3 else 0.0)).x
    assert found == expected
    assert type(found) is type(value)
    assert [type(one) for one in np.ravel(found).tolist()] == [
        type(one) for one in np.ravel(expected).tolist()
    ]


def test_a_fault_keeps_the_type_of_an_array() -> None:
    found = altered(SimpleNamespace(x=array("f", [1.0, 2.0])), "x", lambda x: x + 0.5).x
    assert found == array("f", [1.5, 2.5])
    whole = altered(SimpleNamespace(x=np.array([[1, 2]], np.int16)), "x", lambda x: 1.75 * x).x
    assert (whole.dtype, whole.tolist()) == (np.int16, [[2, 4]])
    real = altered(SimpleNamespace(x=np.array([1.0, 2.0], np.float32)), "x", lambda x: x + 0.25).x
    assert (real.dtype, real.tolist()) == (np.float32, [1.25, 2.25])
    scalar = altered(SimpleNamespace(x=np.float32(1.0)), "x", lambda x: x + 0.25).x
    assert (type(scalar), scalar) == (np.float32, 1.25)


@pytest.mark.parametrize("value", [True, None, "1", b"1", ["a"], [True]])
def test_a_value_that_is_not_a_number_is_refused(value: Any) -> None:
    with pytest.raises(TypeError, match="not a number"):
        altered(SimpleNamespace(x=value), "x", lambda x: x)


def test_values_are_stored_in_mappings_sequences_tuples_and_attributes() -> None:
    message = SimpleNamespace(map={"k": 1}, list=[1, 2, 3], pair=(1, 2), inner=SimpleNamespace(y=1))
    for field in ("map.k", "list.1", "list.-1", "pair.0", "inner.y"):
        store(message, field, 9)
    assert (message.map, message.list, message.pair, message.inner.y) == ({"k": 9}, [1, 9, 9], (9, 2), 9)
    store(message, "inner", 5)
    assert message.inner == 5


class Both:
    """A message whose fields are attributes, and which also has items."""

    def __init__(self) -> None:
        self.x = 1.0
        self.items = [1.0, 2.0]

    def __getitem__(self, at: int) -> float:
        return self.items[at]

    def __setitem__(self, at: int, value: float) -> None:
        self.items[at] = value


def test_message_values_are_items_or_attributes() -> None:
    message = Both()
    store(message, "x", 3.0)
    store(message, "1", 4.0)
    assert (message.x, message.items) == (3.0, [1.0, 4.0])
    other = SimpleNamespace()
    store(other, "0", 1.0)
    assert vars(other) == {"0": 1.0}


def test_the_nominal_size_of_a_fault_means_no_fault() -> None:
    assert faults.bias("/t", "x", -1, 2).extent == Span(-1.0, 2.0, 0.0)
    assert faults.scale("/t", "x", 1, 2).extent == Span(1.0, 2.0, 1.0)
    assert faults.noise("/t", "x", 3).extent == Span(0.0, 3.0, 0.0)
    assert faults.dropout("/t", 1.0).extent == Span(0.0, 1.0, 0.0)
    assert faults.latency("/t", 1e9).extent == Span(0.0, 1e9, 0.0)
    assert faults.swapped("/t", "x", "y").extent == Choice((False, True))
    assert sizes("bias", 0, 1, 0.0) == Span(0.0, 1.0, 0.0)
    assert sizes("scale", 0, 1, 1.0) == Span(0.0, 1.0, 1.0)
    assert up_to("dropout", 0.5, 1.0) == Span(0.0, 0.5, 0.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: faults.dropout("/t", 1.1),
        lambda: faults.duplicates("/t", 0.0),
        lambda: faults.reordering("/t", 2),
        lambda: faults.jitter("/t", 1.1e9),
        lambda: faults.latency("/t", -1.0),
        lambda: faults.freeze("/t", math.nan),
        lambda: faults.restart("node", math.inf, at=1.0),
        lambda: faults.freeze("/t", 1.0, at=math.nan),
        lambda: faults.restart("node", 1.0, at=1.1e9),
        lambda: faults.swapped("", "x", "y"),
        lambda: faults.swapped("/t", "x", ""),
        lambda: faults.swapped("/t", 1, "y"),  # type: ignore[arg-type]
        lambda: faults.bias("", "x", 0, 1),
        lambda: faults.dropout("", 0.5),
        lambda: faults.restart(3, 1.0, at=1.0),  # type: ignore[arg-type]
    ],
)
def test_invalid_sizes_and_names_are_refused(make: Any) -> None:
    with pytest.raises(SettingsError, match=r"^faults\."):
        make()


@pytest.mark.parametrize(
    ("value", "found"), [(0, 0.0), (1e9, 1e9), (-0.1, None), (1.1e9, None), ("1", None), (math.nan, None)]
)
def test_representable_time_is_a_moment(value: Any, found: float | None) -> None:
    assert moment(value) == found


def test_restart_ends_the_node_for_the_given_duration() -> None:
    asked: list[tuple[str, float, float]] = []
    ros = SimpleNamespace(
        interrupt=lambda *given: asked.append(given),
        processes=[SimpleNamespace(name="b"), SimpleNamespace(name="a")],
    )
    fault = faults.restart("a", 5.0, at=2.0)
    fault.install(ros, "crash", 0.5, Draws())  # type: ignore[arg-type]
    assert asked == [("a", 2.0, 0.5)]
    assert fault.extent == Span(0.0, 5.0, 0.0)
    fault.check(ros, "crash")
    with pytest.raises(SettingsError, match="as 'c'; the nodes are a, b"):
        faults.restart("c", 5.0, at=2.0).check(ros, "crash")


class Recorder:
    """Stand-in for a fault that notes its installation and its check."""

    def __init__(self) -> None:
        self.calls: list[Any] = []

    def install(self, _ros: Any, name: str, size: float, draws: np.random.Generator) -> None:
        self.calls.append((name, size, draws.random()))

    def check(self, _ros: Any, name: str) -> None:
        self.calls.append(name)


def test_each_active_fault_has_random_numbers_of_its_own() -> None:
    one, other = Recorder(), Recorder()
    active: Any = {"a": (one, 0.5), "b": (other, 1.0)}
    for seed in (1, 1, 2):
        Faults({}, active, seed).install(None)
    assert [call[:2] for call in one.calls] == [("a", 0.5)] * 3
    assert one.calls[0] == one.calls[1] != one.calls[2]
    assert one.calls[0][2] != other.calls[0][2]


def test_faults_are_checked_only_without_active_faults() -> None:
    one: Any = Recorder()
    Faults({"a": one}).check(None)
    Faults({"a": one}, {"a": (one, 1.0)}).check(None)
    assert one.calls == ["a"]
