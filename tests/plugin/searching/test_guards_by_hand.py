"""Shares of the change, intervals and merits of conditions, worked out by hand."""

from __future__ import annotations

from math import inf, pi

import numpy as np
import pytest

from pytest_tarl import Sensor
from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Conjunct, Guard, Region
from pytest_tarl.searching.candidates import (
    ALWAYS,
    Evidence,
    _combined,
    _conjunct,
    _steepest,
    _values,
    candidate_guards,
    holds,
    share,
    telling,
)
from pytest_tarl.sensors import Cell
from tests.plugin.searching.test_candidates import SEEN, WET, X, world
from tests.plugin.searching.test_gains import ANGLE, LINE, widened

HEADING = Sensor("yaw", topic="/yaw", field="data", bins=8, angle=True)


def along(
    drifted: list[int],
    designed: list[int],
    changes: dict[int, float] | None = None,
    novel: tuple[int, ...] = (),
    sensor: Sensor = X,
) -> Evidence:
    """Return the evidence on one sensor: the bins of the steps in both worlds, and the change by bin."""
    return Evidence(
        (sensor,),
        world(1, [(bin_,) for bin_ in designed]),
        world(2, [(bin_,) for bin_ in drifted]),
        Region((), tuple((bin_,) for bin_ in novel)),
        {(bin_,): change for bin_, change in (changes or {}).items()},
    )


# shares


def test_change_share_is_reduced_by_the_designed_share() -> None:
    shares = along([1, 1, 2, 3], [1, 2, 2, 4], {1: 3.0, 2: 1.0}).shares()
    assert shares == {(1,): 0.75 - 0.25, (2,): 0.25 - 0.5, (3,): 0.0, (4,): -0.25}


def test_new_cell_keeps_its_share_of_drifted_steps() -> None:
    shares = along([1, 5, 5, 5], [1, 1], {1: 8.0}, novel=(5,)).shares()
    assert shares == {(1,): 0.25 - 1.0, (5,): 0.75}


def test_cell_without_drifted_visits_has_no_share() -> None:
    assert along([1, 2], [1, 2], {1: 1.0, 7: 99.0}).shares() == {(1,): 0.5, (2,): -0.5}


def test_new_cell_change_is_counted_once() -> None:
    assert along([1, 5], [1], {1: 1.0, 5: 99.0}, novel=(5,)).shares() == {(1,): -0.5, (5,): 0.5}


def test_unvisited_new_cell_has_no_share() -> None:
    assert along([1, 1], [1], {1: 2.0}, novel=(6,)).shares()[6,] == 0.0


def test_without_any_change_only_the_designed_steps_count() -> None:
    assert along([1, 2], [1, 1], {}).shares() == {(1,): -1.0, (2,): 0.0}


# intervals


def test_the_steepest_interval_has_the_largest_sum_of_shares() -> None:
    seen = along([2, 3, 4, 6], [1, 5, 7], {2: 3.0, 3: 1.0, 4: 3.0, 6: 1.0})
    assert _steepest(seen, 0) == (2, 4)


def test_small_gap_is_included_if_worthwhile() -> None:
    designed = [1] * 8 + [3] * 2
    assert _steepest(along([2, 3, 4], designed, {2: 1.0, 4: 1.0}), 0) == (2, 4)
    designed = [1] * 2 + [3] * 8
    assert _steepest(along([2, 3, 4], designed, {2: 2.0, 4: 1.0}), 0) == (2, 2)


def test_angle_interval_crosses_the_range_end() -> None:
    seen = along([0, 7, 3], [3, 4], {7: 1.0, 0: 1.0, 3: 0.1}, sensor=ANGLE)
    assert _steepest(seen, 0) == (7, 8)
    assert _steepest(along([0, 7, 3], [3, 4], {7: 1.0, 0: 1.0, 3: 0.1}, sensor=LINE), 0) == (0, 0)


def test_an_interval_of_angles_is_at_most_one_turn() -> None:
    seen = along([0, 2, 4, 6], [1], {0: 1.0, 2: 1.0, 4: 1.0, 6: 1.0}, sensor=ANGLE)
    low, high = _steepest(seen, 0) or (0, 0)
    assert high - low < 8
    assert {one % 8 for one in range(low, high + 1)} >= {0, 2, 4, 6}


def test_interval_is_steep_only_with_more_change_than_visits() -> None:
    assert _steepest(along([1, 2], [1, 2], {}), 0) is None


SEEN_BINS = {2, 3, 4, 5, 6}


@pytest.mark.parametrize(
    ("bins", "low", "high"),
    [((3, 4), 3.0, 5.0), ((2, 4), -inf, 5.0), ((4, 6), 4.0, inf), ((2, 2), -inf, 3.0), ((6, 6), 6.0, inf)],
)
def test_end_is_open_without_data_beyond(bins: tuple[int, int], low: float, high: float) -> None:
    assert _conjunct(X, bins, SEEN_BINS) == Conjunct(X, low, high)


def test_ends_of_angles_and_categories_stay_closed() -> None:
    assert _conjunct(ANGLE, (2, 6), SEEN_BINS) == Conjunct(ANGLE, 2.0, 7.0)
    assert _conjunct(WET, (0, 0), {0, 1}) == Conjunct(WET, 0.0, 0.0)


def two(bins: tuple[tuple[int, int] | None, tuple[int, int] | None], second: Sensor = WET) -> list[Guard]:
    cells: list[Cell] = [(x, x % 2) for x in range(10)]
    seen = Evidence((X, second), world(1, cells), world(2, cells), Region(()), {})
    return list(_combined(bins, seen))


ON_X, ON_WET = Conjunct(X, 4.0, 7.0), Conjunct(WET, 1.0, 1.0)


def test_each_condition_is_proposed_alone_and_both_together() -> None:
    assert two(((4, 6), (1, 1))) == [Guard((ON_X,)), Guard((ON_WET,)), Guard((ON_X, ON_WET))]


def test_constant_condition_is_not_proposed() -> None:
    assert two(((0, 9), (1, 1))) == [Guard((ON_WET,))]
    assert two(((4, 6), None)) == [Guard((ON_X,))]
    assert two(((4, 6), (0, 1))) == [Guard((ON_X,))]
    assert two((None, None)) == []


def test_uncheckable_condition_is_not_proposed() -> None:
    assert two(((4, 6), (1, 1)), SEEN) == [Guard((ON_X,))]


def test_bins_of_both_worlds_decide_a_constant_condition() -> None:
    seen = Evidence((X,), world(1, [(4,), (9,)]), world(2, [(4,), (5,)]), Region(()), {})
    assert list(_combined([(4, 6)], seen)) == [Guard((Conjunct(X, -inf, 7.0),))]


def test_each_drifted_boolean_value_gives_a_condition() -> None:
    cells: list[Cell] = [(x, int(x > 3)) for x in range(6)]
    seen = Evidence((X, WET), world(1, [(0, 0), (1, 2)]), world(2, cells), Region(()), {})
    assert list(_values(seen)) == [Guard((Conjunct(WET, one, one),)) for one in (0, 1)]


def test_conditions_are_sorted_by_size_and_share() -> None:
    cells: list[Cell] = [(x, int(x in (4, 5))) for x in range(10)]
    region = Region(((4, 1), (5, 1)))
    seen = Evidence((X, WET), world(1, cells), world(2, cells), region, {})
    guards = candidate_guards(seen)
    assert len(set(guards)) == len(guards)
    assert guards[0] == ALWAYS
    keys = [(len(one.conjuncts), share(one, seen.offline, seen.sensors)) for one in guards]
    assert keys == sorted(keys)
    assert Guard((Conjunct(X, 4.0, 6.0),)) in guards
    assert Guard((Conjunct(X, 2.0, 8.0),)) in guards  # two bins wider


# merits


def guard_on(low: float, high: float, sensor: Sensor = X) -> Guard:
    return Guard((Conjunct(sensor, low, high),))


def test_condition_stores_its_share_of_steps() -> None:
    driven = world(1, [(1,), (1,), (2,), (5,)])
    assert share(guard_on(1.0, 3.0), driven, (X,)) == 0.75
    assert share(guard_on(8.0, 9.0), driven, (X,)) == 0.0
    assert share(ALWAYS, driven, (X,)) == 1.0


def test_condition_on_two_sensors_needs_both_parts() -> None:
    both = Guard((ON_X, ON_WET))
    cells: list[Cell] = [(4, 1), (4, 0), (8, 1), (3, 1), (7, 1)]
    assert [holds(both, one, (X, WET)) for one in cells] == [True, False, False, False, False]


def test_best_condition_is_searched_first() -> None:
    seen = along([1, 1, 2, 2, 3, 8, 8, 8], [1, 2, 3, 4, 5, 6, 7, 8], {1: 4.0, 2: 4.0, 3: 1.0})
    best, second, third = guard_on(1.0, 3.0), guard_on(1.0, 4.0), guard_on(2.0, 3.0)
    assert telling([third, second, best], seen, 4) == (best, ALWAYS, second, third)
    assert telling([third, second, best], seen, 3) == (best, ALWAYS, second)
    assert telling([third, second, best], seen, 1) == (ALWAYS,)


def test_poor_condition_follows_the_unconditional_search() -> None:
    seen = along([1, 2, 3, 4], [1, 2, 3, 4], {1: 1.3, 2: 1.0, 3: 1.0, 4: 1.0})
    assert telling([guard_on(1.0, 2.0)], seen, 2)[0] == ALWAYS


def test_condition_that_never_holds_as_designed_gets_a_bonus() -> None:
    harmless = along([1, 5, 5, 5], [1, 2], {1: 0.1, 5: 0.02}, novel=())
    assert telling([guard_on(5.0, 6.0)], harmless, 2)[0] == guard_on(5.0, 6.0)
    visited = along([1, 5, 5, 5], [1, 2, 1, 2, 1, 2, 1, 2, 1, 5], {1: 0.1, 5: 0.02})
    assert telling([guard_on(5.0, 6.0)], visited, 2)[0] == ALWAYS


def test_condition_with_fewer_parts_wins_a_tie() -> None:
    cells: list[Cell] = [(x, int(x in (4, 5))) for x in range(10)]
    dry: list[Cell] = [(x, 0) for x in range(10)]
    changes = {(4, 1): 1.0, (5, 1): 1.0}
    seen = Evidence((X, WET), world(1, dry), world(2, cells), Region(()), changes)
    one, both = Guard((ON_WET,)), Guard((Conjunct(X, 4.0, 6.0), ON_WET))
    assert telling([both, one], seen, 2)[0] == one


# wider arcs


def test_angle_interval_is_widened_on_both_sides() -> None:
    step = 2 * (2 * pi / 8)
    low, high = widened(HEADING, 0.0, pi / 4)
    assert (low, high) == (pytest.approx(-step), pytest.approx(pi / 4 + step))
    low, high = widened(HEADING, pi / 2, 3 * pi / 4)
    assert (low, high) == (pytest.approx(0.0), pytest.approx(3 * pi / 4 + step - 2 * pi))


def test_full_circle_interval_has_open_ends() -> None:
    assert widened(ANGLE, 0.0, 3.0) == (6.0, 5.0)
    assert widened(ANGLE, 0.0, 4.0) == (-inf, inf)
    assert widened(ANGLE, 6.0, 2.0) == (-inf, inf)
    assert widened(ANGLE, 6.0, 1.0) == (4.0, 3.0)


def test_an_empty_sample_has_no_share() -> None:
    driven: Sample = world(1, [(1,)])
    assert share(guard_on(1.0, 2.0), driven, (X,)) == 1.0
    assert np.isfinite(share(guard_on(5.0, 6.0), driven, (X,)))
