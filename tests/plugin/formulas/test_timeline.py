"""Signals over time, as formulas read them: step functions that keep the last given value."""

from __future__ import annotations

from math import nan

from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.formulas.signals import Timeline

GIVEN = st.lists(st.tuples(st.integers(0, 6), st.sampled_from([0.0, 1.0, 2.5, nan])), min_size=1, max_size=12)


@given(given=GIVEN)
def test_each_instant_has_the_latest_earlier_value(given: list[tuple[int, float]]) -> None:
    given = sorted(given, key=lambda one: one[0])  # in the order of time
    timeline = Timeline(["x"])
    for time, value in given:
        timeline.give("x", value, time)
    numbers = [(time, value) for time, value in given if value == value]
    if not numbers:
        assert timeline.missing(["x"]) == "x"
        return
    for instant in range(8):
        before = [value for time, value in numbers if time <= instant]
        expected = before[-1] if before else timeline.samples(["x"])["x"][0][1]
        assert timeline.at(["x"], instant) == {"x": expected}
    first = [value for time, value in numbers if time == numbers[0][0]]
    assert timeline.samples(["x"])["x"][0] == [0, first[-1]]


def test_instants_are_begin_end_and_changes() -> None:
    line = Timeline(("a", "b"))
    for name, value, time in (("a", 1.0, 5), ("a", 1.0, 6), ("a", 2.0, 9), ("b", 0.0, 7), ("b", True, 12)):
        line.give(name, value, time)
    assert line.instants(("a", "b"), 12) == [0, 5, 7, 9, 12]
    assert line.instants(("b",), 7) == [0, 7]
    assert line.at(("a", "b"), 8) == {"a": 1.0, "b": 0.0}
    assert line.at(("a",), 3) == {"a": 1.0}
    assert line.samples(("a",)) == {"a": [[0, 1.0], [9, 2.0]]}
    assert line.missing(("a", "b")) is None
    assert Timeline(("a", "c")).missing(("c", "a")) == "c"
