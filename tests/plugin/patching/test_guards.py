"""Conditions of repairs in Python: their text, the expressions they read, and no effect before the first message."""

from __future__ import annotations

import ast
import math
from textwrap import dedent

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.document import document
from pytest_tarl.patching.guards import Reading, condition, held
from tests.plugin.patching.repairs import POSITION, TERRAIN, TOPICS

GEAR = Sensor("gear", topic="/gear", field="data")
MODE = Sensor("mode", topic="/mode", field="data", categories=("dry", "wet", 'so-"so"'))
SEEN = {
    "terrain": Reading("terrain", "terrain"),
    "x": Reading("pos"),
    "gear": Reading("gear"),
    "mode": Reading("mode"),
}
SILENT = {name: Reading(name, name) for name in ("terrain", "x", "gear", "mode")}
INF = math.inf


def told(*conjuncts: Conjunct, readings: dict[str, Reading] = SEEN) -> str:
    return condition(Guard(conjuncts), readings, TOPICS)


@pytest.mark.parametrize(
    ("conjunct", "expected"),
    [
        (Conjunct(TERRAIN, 1, 1), "terrain"),
        (Conjunct(POSITION, 4.0, 7.0), "4.0 <= pos < 7.0"),
        (Conjunct(POSITION, 4.0, 10.0), "4.0 <= pos <= 10.0"),
        (Conjunct(POSITION, 10.0, INF), "pos > 10.0"),
        (Conjunct(POSITION, 4.0, INF), "pos >= 4.0"),
        (Conjunct(POSITION, -INF, 4.0), "pos < 4.0"),
        (Conjunct(POSITION, -INF, 10.0), "pos <= 10.0"),
        (Conjunct(POSITION, -INF, INF), ""),
        (Conjunct(GEAR, 3, 3), "gear == 3"),
        (Conjunct(GEAR, 1, 3), "1 <= gear <= 3"),
        (Conjunct(GEAR, 2, INF), "gear >= 2"),
        (Conjunct(MODE, 1, 1), 'mode == "wet"'),
        (Conjunct(MODE, 0, 1), 'mode in ("dry", "wet")'),
        (Conjunct(MODE, 1, INF), 'mode in ("wet", \'so-"so"\')'),
    ],
)
def test_each_kind_of_sensor_has_its_condition(conjunct: Conjunct, expected: str) -> None:
    assert told(conjunct) == expected


@pytest.mark.parametrize(
    ("conjunct", "expected"),
    [
        (Conjunct(TERRAIN, 1, 1), "terrain"),
        (Conjunct(TERRAIN, 0, 0), "terrain is not None and not terrain"),
        (Conjunct(POSITION, 4.0, 7.0), "x is not None and 4.0 <= x < 7.0"),
        (Conjunct(GEAR, 0, 0), "gear == 0"),
        (Conjunct(MODE, 0, 1), 'mode in ("dry", "wet")'),
    ],
)
def test_condition_checks_for_none_only_before_a_failing_comparison(
    conjunct: Conjunct, expected: str
) -> None:
    text = told(conjunct, readings=SILENT)
    assert text == expected
    assert not eval(text, {conjunct.sensor.name: None})


def test_conditions_are_combined_in_order() -> None:
    assert told(Conjunct(TERRAIN, 1, 1), Conjunct(POSITION, 4, 7)) == "terrain and 4.0 <= pos < 7.0"


def test_condition_without_bounds_is_empty() -> None:
    assert told() == told(Conjunct(POSITION, -INF, INF)) == ""


def test_bounds_are_rounded_to_a_hundredth_of_a_bin() -> None:
    fine = Sensor("x", topic="/odom", field="x", low=0, high=10, bins=24)
    assert told(Conjunct(fine, *fine.interval(10, 16))) == "4.167 <= pos < 7.083"
    wide = Sensor("x", topic="/odom", field="x", low=-5e4, high=5e4, bins=3)
    assert told(Conjunct(wide, *wide.interval(1, 1))) == "-16700.0 <= pos < 16700.0"


@settings(max_examples=200)
@given(
    low=st.floats(-100, 100),
    width=st.floats(0.01, 50),
    bins=st.integers(1, 30),
    ends=st.tuples(st.integers(-1, 30), st.integers(-1, 30)).map(sorted),
    value=st.floats(-300, 300),
)
def test_condition_holds_in_its_bins_up_to_rounding(
    low: float, width: float, bins: int, ends: list[int], value: float
) -> None:
    sensor = Sensor("x", topic="/odom", field="x", low=low, high=low + width * bins, bins=bins)
    first, last = (min(end, bins) for end in ends)
    text = told(Conjunct(sensor, *sensor.interval(first, last)))
    position = (value - low) / width
    if abs(position - round(position)) > 0.02:  # not within rounding of the end of a bin
        index = sensor.bin(value)
        assert index is not None
        assert bool(eval(text or "True", {"pos": value})) is (first <= index <= last)


@pytest.mark.parametrize("value", [0.0, 4.0, 7.0, 10.0, 10.5, -0.5])
def test_bin_ends_are_open_as_in_the_sensor(value: float) -> None:
    for first, last in ((-1, -1), (0, 3), (4, 6), (7, 9), (10, 10)):
        text = told(Conjunct(POSITION, *POSITION.interval(first, last)))
        index = POSITION.bin(value)
        assert index is not None
        assert eval(text, {"pos": value}) is (first <= index <= last)


STRETCH = Conjunct(POSITION, 4.0, 7.0)
START = Conjunct(POSITION, -INF, 4.0)
MUDDY, FIRM = Conjunct(TERRAIN, 1, 1), Conjunct(TERRAIN, 0, 0)


def choose(text: str, expressions: tuple[str, ...], conjunct: Conjunct = STRETCH) -> Reading | None:
    """Return the expression chosen at the statement that contains `HERE`."""
    source = document("node.py", dedent(text))
    name = next(node for node in ast.walk(source.tree) if isinstance(node, ast.Name) and node.id == "HERE")
    return held(source, source.statement(name), expressions, conjunct)


def test_the_first_safe_expression_is_used() -> None:
    text = """
        pos = 5.0
        def cb(msg):
            global pos
            pos = msg.x
            HERE = 1
        """
    assert choose(text, ("pos", "msg.x")) == Reading("msg.x")


@pytest.mark.parametrize(
    ("initial", "conjunct"), [("0.0", START), ("Pose()", START), ("False", FIRM), ("True", MUDDY)]
)
def test_variable_that_starts_inside_the_condition_is_not_used(initial: str, conjunct: Conjunct) -> None:
    text = f"value = {initial}\ndef step(): HERE = 1\n"
    assert choose(text, ("value",), conjunct) is None


@pytest.mark.parametrize(("initial", "conjunct"), [("0.0", STRETCH), ("Pose()", STRETCH), ("False", MUDDY)])
def test_variable_that_starts_outside_the_condition_is_used(initial: str, conjunct: Conjunct) -> None:
    text = f"value = {initial}\ndef step(): HERE = 1\n"
    assert choose(text, ("value",), conjunct) == Reading("value")


@pytest.mark.parametrize(
    ("text", "expression", "absent"),
    [
        ("pos = None\ndef step(): HERE = 1", "pos", "pos"),
        ("pos, other = None, 1\ndef step(): HERE = 1", "pos.x", "pos"),
        ("pos = None\ndef step():\n    if pos is None:\n        return\n    HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    if pos is None or done:\n        return\n    HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    if pos is None and done:\n        return\n    HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    if not pos:\n        return\n    HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    while pos is None:\n        wait()\n    HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    while pos is None:\n        break\n    HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    if pos is not None and go:\n        HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    if pos is not None or go:\n        HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    if pos is not None:\n        pass\n    else:\n        HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    delta = goal - pos\n    HERE = 1", "pos", ""),
        ("pos = None\ndef step():\n    HERE = goal - pos", "pos", ""),
        ("pos = None\ndef step():\n    while goal - pos > HERE:\n        pass", "pos", "pos"),
        ("pos = None\ndef step():\n    HERE = goal - pos if go else 0", "pos", "pos"),
        ("pos = None\ndef step():\n    HERE = lambda: goal - pos", "pos", "pos"),
        ("pos = None\ndef step():\n    delta = go and goal - pos\n    HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    for i in y:\n        delta = goal - pos\n    HERE = 1", "pos", "pos"),
        ("pos = None\ndef step():\n    delta = pos.x\n    while go:\n        HERE = 1", "pos.x", ""),
        ("def step(pos):\n    HERE = 1\ndef other():\n    pos = None", "pos", ""),
    ],
)  # fmt: skip
def test_condition_checks_for_none_unless_excluded(text: str, expression: str, absent: str) -> None:
    assert choose(text, (expression,)) == Reading(expression, absent)


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        (
            "class N:\n    def __init__(self):\n        self.p = None\n    def step(self):\n        HERE = 1",
            True,
        ),
        ("class N:\n    p = None\n    def step(self):\n        HERE = 1", True),
        (
            "class N:\n    def cb(self, m):\n        self.p = m.x\n    def step(self):\n        HERE = 1",
            False,
        ),
        (
            "class N:\n    def cb(self, m):\n        self.p = m.x\n    def step(self):\n        HERE = self.p",
            True,
        ),
    ],
)
def test_condition_uses_an_attribute_only_where_the_code_reads_it(text: str, bound: bool) -> None:
    assert (choose(text, ("self.p",)) is not None) is bound


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        ("def cb(m):\n    global p\n    p = m.x\ndef step(): HERE = 1", False),
        ("def cb(m):\n    global p\n    p = m.x\ndef step(): HERE = p + 1", True),
        ("p = 0.0\ndef step(): HERE = 1", True),
        ("def step(p): HERE = 1", True),
    ],
)
def test_condition_uses_a_global_only_where_the_code_reads_it(text: str, bound: bool) -> None:
    assert (choose(text, ("p",)) is not None) is bound


@pytest.mark.parametrize("expression", ["latest()", "a + b", "cache[key]", "cache['x']"])
def test_expressions_with_effects_are_not_used(expression: str) -> None:
    assert choose("cache = {}\na = b = key = 1.0\ndef step(): HERE = 1", (expression,)) is None


def turned(low: float, high: float, lowest: float, highest: float) -> str:
    sensor = Sensor("yaw", topic="/yaw", field="data", low=lowest, high=highest, bins=8, angle=True)
    return condition(Guard((Conjunct(sensor, low, high),)), {"yaw": Reading("yaw")}, TOPICS)


@pytest.mark.parametrize(
    ("low", "high", "lowest", "highest"), [(135.0, -90.0, -180.0, 180.0), (270.0, 45.0, 0.0, 360.0)]
)
def test_angle_condition_may_cross_the_range_end(
    low: float, high: float, lowest: float, highest: float
) -> None:
    code = turned(low, high, lowest, highest)
    inside = [low, (low + highest) / 2, lowest, (lowest + high) / 2, high - 0.5]
    outside = [high, high + 0.5, (low + high) / 2, low - 0.5]
    assert [eval(code, {"yaw": value}) for value in inside] == [True] * len(inside)
    assert [eval(code, {"yaw": value}) for value in outside] == [False] * len(outside)


def test_wrapping_condition_is_relative_to_its_low_end() -> None:
    assert turned(135.0, -90.0, -180.0, 180.0) == "(yaw - 135.0) % 360.0 < 135.0"
    assert turned(-0.5, -0.75, -1.0, 1.0) == "(yaw + 0.5) % 2.0 < 1.75"
