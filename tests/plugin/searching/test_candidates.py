"""Conditions are proposed from the region and from new cells; each one states how often it holds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl import Sensor
from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Conjunct, Guard, Region
from pytest_tarl.searching.candidates import (
    ALWAYS,
    Evidence,
    candidate_guards,
    firing_episodes,
    holds,
    share,
    telling,
)
from pytest_tarl.sensors import Cell

X = Sensor("x", topic="/odom", field="x", low=0, high=10, bins=10)
WET = Sensor("wet", topic="/wet", field="data")
SEEN = Sensor("seen")  # observed only: no condition can read it


def world(seed: int, cells: list[Cell]) -> Sample:
    distinct = tuple(dict.fromkeys(cells))
    steps = len(cells)
    trace = Trace(
        cells=distinct,
        site=np.zeros(0, np.int32),
        flow=np.zeros(0),
        event_cell=np.zeros(0, np.int32),
        event_step=np.zeros(0, np.int32),
        step_cell=np.array([distinct.index(cell) for cell in cells], np.int32),
        reward=np.zeros(steps),
        parts={},
    )
    return sample(trace, seed, True, ())


def drive(seed: int, wet: range, sensors: int = 2) -> Sample:
    return world(seed, [(x, int(x in wet), 0)[:sensors] for x in range(10)])


OFFLINE = merge([drive(1, range(0)), drive(2, range(4, 7))])
ONLINE = drive(3, range(4, 7))
REGION = Region(tuple((x, 1) for x in (4, 5, 6)))


CHANGES = {(4, 1): 2.0, (5, 1): 2.0, (6, 1): 2.0, (8, 0): 0.1}


def evidence(
    region: Region,
    sensors: tuple[Sensor, ...] = (X, WET),
    worlds: tuple[Sample, Sample] = (OFFLINE, ONLINE),
    changes: dict[Cell, float] | None = None,
) -> Evidence:
    return Evidence(sensors, *worlds, region, changes or {})


def test_conditions_on_one_sensor_come_first() -> None:
    guards = candidate_guards(evidence(REGION))
    assert guards[0] == ALWAYS
    assert guards[1] == Guard((Conjunct(WET, 1.0, 1.0),))
    assert guards[2] == Guard((Conjunct(X, 4.0, 7.0),))
    sizes = [len(guard.conjuncts) for guard in guards]
    assert sizes == sorted(sizes)
    assert max(sizes) == 2


def test_conditions_hold_where_much_changed() -> None:
    mixed = merge([drive(3, range(4, 7)), drive(4, range(0))])
    seen = evidence(REGION, worlds=(OFFLINE, mixed), changes=CHANGES)
    assert telling(candidate_guards(seen), seen, most=2) == (Guard((Conjunct(WET, 1.0, 1.0),)), ALWAYS)


def test_region_of_all_cells_uses_the_observed_changes() -> None:
    spread = Region((*REGION.cells, (0, 0), (9, 0)))
    seen = evidence(spread, changes=CHANGES)
    assert Guard((Conjunct(WET, 1.0, 1.0),)) in candidate_guards(seen)
    assert Guard((Conjunct(X, 4.0, 7.0),)) in candidate_guards(seen)
    assert all(one.sensor == WET for guard in candidate_guards(evidence(spread)) for one in guard.conjuncts)


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 3)), min_size=1, max_size=30), st.integers(0, 3))
def test_every_unordered_drifted_value_gives_a_condition(cells: list[Cell], at: int) -> None:
    kind = Sensor("kind", topic="/kind", field="data", categories=("a", "b", "c", "d"))
    worlds = (world(1, [(0, at), (5, (at + 1) % 4)]), world(2, cells))
    guards = candidate_guards(evidence(Region(()), (X, kind), worlds))
    for value in {cell[1] for cell in cells}:
        assert Guard((Conjunct(kind, value, value),)) in guards


def test_unconditional_search_comes_first_if_the_condition_always_holds() -> None:
    stuck = world(3, [(2, 0)] * 10)
    cells = [(2, 0)]
    seen = evidence(Region(tuple(cells)), worlds=(OFFLINE, stuck), changes={(2, 0): 5.0})
    assert telling(candidate_guards(seen), seen, most=3) == (ALWAYS,)


def test_unconditional_search_precedes_a_wide_condition() -> None:
    stuck = world(3, [(2, 0)] * 39 + [(9, 1)])
    seen = evidence(Region(((2, 0),)), worlds=(OFFLINE, stuck), changes={(2, 0): 5.0})
    first, second = telling(candidate_guards(seen), seen, most=3)
    assert first == ALWAYS
    assert 0.9 < share(second, stuck, (X, WET)) < 1.0


def test_without_a_useful_condition_the_search_uses_no_condition() -> None:
    seen = evidence(REGION, changes={})
    assert telling(candidate_guards(seen), seen, most=3) == (ALWAYS,)
    assert telling((), seen, most=3) == (ALWAYS,)


def test_unreadable_sensor_is_in_no_condition() -> None:
    online = drive(3, range(4, 7), 3)
    guards = candidate_guards(evidence(Region(((4, 1, 0),)), (X, WET, SEEN), (online, online)))
    assert all(conjunct.sensor != SEEN for guard in guards for conjunct in guard.conjuncts)


def test_region_of_all_cells_gives_no_condition() -> None:
    everywhere = Region(tuple(ONLINE.cells))
    dry = drive(1, range(0))
    guards = candidate_guards(evidence(everywhere, worlds=(dry, drive(4, range(10)))))
    assert all(conjunct.sensor == WET for guard in guards for conjunct in guard.conjuncts)


def test_interval_is_unbounded_without_bins_beyond() -> None:
    guards = candidate_guards(evidence(Region(((8, 0), (9, 0)))))
    assert Guard((Conjunct(X, 8.0, math.inf),)) in guards


def test_new_cells_give_a_condition_on_the_new_value() -> None:
    seen = evidence(Region(((2, 0), (3, 0)), ((5, 1),)), worlds=(drive(1, range(0)), ONLINE))
    guards = candidate_guards(seen)
    assert Guard((Conjunct(WET, 1.0, 1.0),)) in guards


@pytest.mark.parametrize(
    ("cell", "expected"), [((4, 1), True), ((6, 1), True), ((7, 1), False), ((4, 0), False)]
)
def test_a_condition_holds_in_the_cells_of_its_bins(cell: Cell, expected: bool) -> None:
    guard = Guard((Conjunct(X, 4.0, 7.0), Conjunct(WET, 1.0, 1.0)))
    assert holds(guard, cell, (X, WET)) is expected


def test_condition_stores_where_it_holds() -> None:
    guard = Guard((Conjunct(WET, 1.0, 1.0),))
    assert share(guard, OFFLINE, (X, WET)) == 3 / 20
    assert firing_episodes(guard, OFFLINE, (X, WET)) == (2,)
    assert firing_episodes(ALWAYS, OFFLINE, (X, WET)) == (1, 2)


def test_widened_condition_includes_all_or_no_outer_values() -> None:
    outside = world(9, [(x, 0) for x in (-1, 0, 1, 2, 5, 8, 9, 10)])
    for region in (((1, 0), (2, 0)), ((8, 0),)):
        guards = candidate_guards(evidence(Region(region), worlds=(outside, outside)))
        limits = [(c.low, c.high) for guard in guards for c in guard.conjuncts if c.sensor == X]
        assert limits
        assert all(low >= 0 or low == -math.inf for low, _ in limits)
        assert all(high <= 10 or high == math.inf for _, high in limits)
