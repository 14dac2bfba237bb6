"""A region that crosses the ends of an angle's range has one description and one condition."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.guards import Reading, condition
from pytest_tarl.report.sensor_regions import Vocabulary
from pytest_tarl.searching import candidates
from pytest_tarl.searching.candidates import holds

HEADING = Sensor("heading", topic="/pose", field="theta", bins=12, angle=True, unit="rad")
ACROSS = Conjunct(HEADING, *HEADING.interval(10, 13))  # the region: the last two bins and the first two


def test_hull_of_cells_takes_the_shorter_arc() -> None:
    assert candidates._hull([(11,), (0,), (1,)], 0, HEADING) == (11, 13)
    assert candidates._hull([(3,), (5,)], 0, HEADING) == (3, 5)
    assert candidates._hull([(11,), (3,)], 0, HEADING) == (11, 15)


@given(st.floats(-20, 20))
def test_condition_holds_in_its_arc_after_any_turns(
    value: float,
) -> None:
    code = condition(Guard((ACROSS,)), {"heading": Reading("theta")}, {})
    assert " or " not in code
    index = HEADING.bin(value)
    low, high = ACROSS.low, ACROSS.high
    if min(abs((value - edge + 1) % math.tau - 1) for edge in (low, high)) > 0.02:  # limits are rounded
        assert eval(code, {"theta": value}) is (index in (10, 11, 0, 1))


def test_a_cell_satisfies_the_condition_of_its_arc() -> None:
    assert [i for i in range(12) if holds(Guard((ACROSS,)), (i,), (HEADING,))] == [0, 1, 10, 11]


def test_region_description_crosses_the_range_end() -> None:
    vocabulary = Vocabulary((HEADING,), [(i,) for i in range(12)])
    assert vocabulary.words([(10,), (11,), (0,), (1,)]) == "heading above 2.1 or below -2.1 rad"
    assert vocabulary.words([(0,), (5,)]).startswith("heading -3.1 to -2.6 or ")


def test_widened_arc_may_be_the_whole_circle() -> None:
    wider = candidates._wider(ACROSS)
    assert [i for i in range(12) if holds(Guard((wider,)), (i,), (HEADING,))] == [0, 1, 2, 3, 8, 9, 10, 11]
    whole = candidates._wider(wider)
    assert whole.low == pytest.approx(-math.inf)
