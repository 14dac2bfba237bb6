from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.report.sensor_regions import Vocabulary, boxes, bridged, closed
from pytest_tarl.sensors import Sensor

X = Sensor("x", low=0, high=10, bins=10, unit="m")
TERRAIN = Sensor("terrain")
LANE = Sensor("lane")
LIGHT = Sensor("light", categories=("day", "dusk", "night"))
CELLS = st.sets(st.tuples(st.integers(-1, 5), st.integers(0, 2), st.integers(0, 1)), max_size=30)


def inside(cover):
    return {
        (x, y, z)
        for (a, b), (c, d), (e, f) in cover
        for x in range(a, b + 1)
        for y in range(c, d + 1)
        for z in range(e, f + 1)
    }


@given(CELLS)
def test_boxes_cover_exactly_the_cells(cells):
    cover = boxes(cells)
    assert inside(cover) == cells
    assert sum((b - a + 1) * (d - c + 1) * (f - e + 1) for (a, b), (c, d), (e, f) in cover) == len(cells)


@given(CELLS, CELLS)
def test_boxes_never_include_a_visited_cell_outside_the_region(cells, others):
    joined = inside(bridged(boxes(cells), others - cells))
    assert cells <= joined
    assert not joined & (others - cells)


RING = st.sets(st.tuples(st.integers(0, 2), st.integers(0, 7), st.integers(0, 1)), max_size=30)


@given(RING)
def test_boxes_at_both_ends_of_an_angle_are_joined(cells):
    cover = boxes(cells)
    joined = closed(cover, 1, 8)
    assert {(x, angle % 8, z) for x, angle, z in inside(joined)} == cells
    assert sum((d - c + 1) * (b - a + 1) * (f - e + 1) for (a, b), (c, d), (e, f) in joined) == len(cells)
    ends = [(box[0], box[2]) for box in joined if box[1][1] == 7 and box[1][0] > 0]
    assert not [box for box in joined if box[1][0] == 0 and (box[0], box[2]) in ends]


def test_joined_angle_box_extends_beyond_the_range_end():
    assert closed((((4, 4), (0, 1)), ((4, 4), (6, 7))), 1, 8) == (((4, 4), (6, 9)),)


def test_a_full_rectangle_gives_one_box():
    assert boxes((x, y) for x in range(3, 7) for y in range(2)) == (((3, 6), (0, 1)),)


def test_sensors_kept_separate_are_never_merged():
    assert boxes([(1, 0), (1, 1)], apart=[1]) == (((1, 1), (0, 0)), ((1, 1), (1, 1)))


def words(cells, sensors=(X, TERRAIN), seen=None):
    everywhere = [(x, t) for x in range(-1, 11) for t in (0, 1)]
    return Vocabulary(sensors, everywhere if seen is None else seen).words(cells)


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        ([(4, 1), (5, 1), (6, 1)], "x 4-7 m, terrain true"),
        ([(4, 0), (5, 0)], "x 4-6 m, terrain false"),
        ([(4, 0), (4, 1)], "x 4-5 m"),
        ([(1, 1), (4, 1), (5, 1)], "x 1-2 or 4-6 m, terrain true"),
        ([(-1, 1), (0, 1)], "x below 1 m, terrain true"),
        ([(9, 1), (10, 1)], "x above 9 m, terrain true"),
        ([(x, 1) for x in range(-1, 11)], "x anywhere, terrain true"),
        ([(1, 0), (4, 1), (5, 1)], "x 1-2 m, terrain false; x 4-6 m, terrain true"),
        ([], "nowhere"),
    ],
)
def test_a_region_is_named_by_its_intervals(cells, expected):
    assert words(cells) == expected


def test_the_description_closes_gaps_of_unvisited_cells():
    seen = [(3, 1), (4, 1), (6, 1), (8, 1)]
    assert words([(3, 1), (4, 1), (6, 1)], seen=seen) == "x 3-7 m, terrain true"


def test_the_description_keeps_gaps_of_visited_cells():
    seen = [(3, 1), (4, 1), (6, 1)]
    assert words([(3, 1), (6, 1)], seen=seen) == "x 3-4 or 6-7 m, terrain true"


def test_a_long_list_of_boxes_is_shortened():
    cells = [(2 * i, i % 2, i) for i in range(5)]
    seen = [(x, t, lane) for x in range(10) for t in (0, 1) for lane in range(5)]
    assert words(cells, (X, TERRAIN, LANE), seen).endswith("; and 2 more")


def test_long_interval_list_is_shortened():
    everything = [(x, 1) for x in range(10)]
    assert words([(x, 1) for x in (0, 2, 4, 6, 8)], seen=everything) == (
        "x 0-1 or 2-3 or 4-5 m or 2 more, terrain true"
    )


def test_integers_above_one_are_not_shown_as_booleans():
    assert words([(0,), (1,)], (LANE,), [(0,), (1,), (2,)]) == "lane 0 or 1"


def test_categories_are_shown_by_name():
    assert words([(0, 1), (0, 2)], (X, LIGHT), [(0, 0), (0, 1), (0, 2)]) == "x 0-1 m, light dusk or night"


def test_a_region_of_all_categories_is_everywhere():
    assert words([(0,), (1,)], (TERRAIN,), [(0,), (1,)]) == "everywhere"


def test_negative_ranges_use_a_word_for_the_dash():
    heading = Sensor("heading", low=-3, high=3, bins=6, unit="rad")
    assert words([(0,), (1,)], (heading,), [(i,) for i in range(6)]) == "heading -3 to -1 rad"


def test_narrow_bins_get_enough_digits():
    fine = Sensor("offset", low=0, high=0.1, bins=20)
    assert words([(3,)], (fine,), [(i,) for i in range(20)]) == "offset 0.015-0.020"


def test_region_around_the_angle_end_is_one_range():
    heading = Sensor("heading", low=-180, high=180, bins=8, unit="deg", angle=True)
    everything = [(i,) for i in range(8)]
    assert words([(0,), (1,), (7,)], (heading,), everything) == "heading above 135 or below -90 deg"
    assert words([(0,), (1,)], (heading,), everything) == "heading -180 to -90 deg"
    straight = Sensor("heading", low=-180, high=180, bins=8, unit="deg")
    assert words([(0,), (7,)], (straight,), everything) == "heading -180 to -135 or 135-180 deg"


def test_a_bin_is_named_with_and_without_its_sensor():
    vocabulary = Vocabulary((X, TERRAIN), [(0, 0), (3, 1)])
    assert (vocabulary.bin(0, 3), vocabulary.value(0, 3)) == ("x 3-4 m", "3-4 m")
    assert (vocabulary.bin(1, 1), vocabulary.value(1, 0)) == ("terrain true", "false")


def test_the_only_value_of_a_category_is_named():
    assert words([(2, 1)], (X, TERRAIN), [(2, 1), (5, 1)]) == "x 2-3 m, terrain true"
    assert words([(2, 0)], (X, TERRAIN), [(2, 0), (5, 1)]) == "x 2-3 m, terrain false"


def test_ranges_below_and_above_the_sensor_are_open():
    assert words([(-1, 1)], seen=[(-1, 1), (0, 0), (10, 0)]) == "x below 0 m, terrain true"
    assert words([(10, 0)], seen=[(-1, 1), (0, 0), (10, 0)]) == "x above 10 m, terrain false"


def test_number_of_boxes_does_not_depend_on_sensor_order():
    row, column = [(0, 0), (1, 0), (2, 0)], [(1, 1), (1, 2)]
    assert boxes(row + column) == (((0, 2), (0, 0)), ((1, 1), (1, 2)))
    assert boxes([(b, a) for a, b in row + column]) == (((0, 0), (0, 2)), ((1, 2), (1, 1)))
    assert boxes([(0, 0), (1, 0), (1, 1)]) == (((0, 0), (0, 0)), ((1, 1), (0, 1)))
