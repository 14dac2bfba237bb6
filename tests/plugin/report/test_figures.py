from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from pytest_tarl.model import Region
from pytest_tarl.report.figures import _axis, number, plane, reward_curves, split_values, utility_figure
from pytest_tarl.report.slices import Scale, chart, scale
from pytest_tarl.sensors import Sensor
from tests.plugin.report.conftest import X


def figure(comparison, number=0):
    return utility_figure(comparison, comparison.lists[number])


def test_every_figure_is_valid_json_without_nan(any_comparison):
    figures = [utility_figure(any_comparison, one) for one in any_comparison.lists]
    json.dumps([figures, reward_curves(any_comparison)], allow_nan=False)


def test_terrain_splits_the_shuttle_figure(shuttle):
    found = figure(shuttle)
    assert [row["title"] for row in found["rows"]] == ["terrain false", "terrain true"]
    assert found["axis"]["title"] == "x (m)"
    assert found["axis"]["names"][10] == "x 4.2-4.6 m"
    assert found["sites"][5] == [30, "vel = 5 * delta", "traveller.py"]


def test_figure_has_null_for_sites_that_did_not_run(shuttle):
    true = figure(shuttle)["rows"][1]
    cell = shuttle.cells.index((12, 1))
    assert true["online"][5][12] == pytest.approx(shuttle.lists[0].online[cell, 5], rel=1e-4)
    assert true["online"][5][3] is None
    assert figure(shuttle)["rows"][0]["offline"][0][0] is None


def test_figure_row_shows_its_regions_as_intervals(shuttle):
    false, true = figure(shuttle)["rows"]
    assert (false["region"], true["region"]) == (
        [],
        [[pytest.approx(4.1667, abs=1e-3), pytest.approx(7.0833, abs=1e-3)]],
    )
    assert len(false["paper"]) == 1


def test_figure_row_shows_the_category_that_explains_most(two_lists):
    assert [two_lists.sensors[d].name for d in (plane(two_lists).position, plane(two_lists).split)] == [
        "x",
        "light",
    ]
    assert plane(two_lists).others(two_lists.sensors) == ("terrain",)


def test_other_sensors_are_averaged_over_visited_cells_only(two_lists):
    one = two_lists.lists[0]
    rows = [two_lists.cells.index((3, terrain, 0)) for terrain in (0, 1)]
    offline = one.offline.copy()
    offline[rows[0], 2], offline[rows[1], 2] = 4.0, 6.0
    offline[rows[0], 3], offline[rows[1], 3] = math.nan, 7.0
    found = utility_figure(two_lists, replace(one, offline=offline))["rows"][0]["offline"]
    assert (found[2][4], found[3][4]) == (5.0, 7.0)  # bins start at -1


def test_without_a_numeric_sensor_a_category_is_the_axis(varied):
    light = Sensor("light", categories=("day", "night"))
    comparison = varied(sensors=(light,), cells=((0,), (1,)), region=Region(((1,),)), paper_region=())
    one = replace(comparison.lists[0], offline=np.ones((2, 7)), online=np.zeros((2, 7)))
    found = utility_figure(comparison, one)
    assert found["axis"]["ticks"] == ["day", "night"]
    assert [row["region"] for row in found["rows"]] == [[[0.5, 1.5]]]


def test_noise_does_not_get_the_strongest_colours(unchanged, shuttle):
    found = figure(unchanged)
    assert found["reach"] == pytest.approx(0.25 * (found["range"][1] - found["range"][0]), rel=1e-3)
    change = shuttle.lists[0].online - shuttle.lists[0].offline
    assert figure(shuttle)["reach"] == pytest.approx(np.nanmax(np.abs(change)), rel=1e-4)


def test_the_scale_of_a_figure_covers_all_shown_values(two_lists):
    found = figure(two_lists)
    shown = [
        v
        for row in found["rows"]
        for w in ("offline", "online")
        for line in row[w]
        for v in line
        if v is not None
    ]
    assert found["range"] == [min(shown), max(shown)]


def test_without_cells_there_is_no_figure(varied):
    assert figure(varied(cells=())) is None


def test_curves_are_running_means(varied):
    offline, online = reward_curves(
        varied(totals={"offline": (1.0, 3.0, 5.0), "online": (2.0,)}, searches=())
    )
    assert offline["mean"] == [1.0, 2.0, 3.0]
    assert offline["totals"] == [1.0, 3.0, 5.0]
    assert online["name"] == "deployed (mud)"


def test_every_search_has_a_labelled_curve(shuttle):
    searches = [curve for curve in reward_curves(shuttle) if curve["kind"] == "search"]
    assert [curve["name"] for curve in searches] == ["search: epsilon-greedy", "search: sweep"]
    assert len(searches[0]["labels"]) == 60


def test_the_peak_is_the_site_with_the_largest_difference(shuttle):
    assert [row.site.line for row in chart(shuttle.lists[0].slices).rows if row.peak] == [30]


def test_without_any_difference_there_is_no_peak(unchanged):
    assert not any(row.peak for row in chart(unchanged.lists[0].slices).rows)


def test_unknown_slices_have_a_row_without_a_value(shuttle):
    slices = list(shuttle.lists[0].slices)
    slices[2] = replace(slices[2], online=math.nan)
    found = chart(slices)
    assert [row.known for row in found.rows] == [True, True, False, True, True, True, True]
    assert math.isfinite(found.values.low)


@pytest.mark.parametrize("values", [[-3.0, 8.0], [1e-7], [-1e6, -2e6], [], [0.0], [math.nan, 2.0]])
def test_scales_include_zero_and_have_round_ticks(values):
    made = scale(values)
    for value in [0.0, *(v for v in values if math.isfinite(v))]:
        assert 0 <= made.at(value) <= 100
    assert 0.0 in made.ticks
    assert 2 <= len(made.ticks) <= 7


@pytest.mark.parametrize(
    ("width", "step"),
    [
        (4.0, 1.0),
        (4.1, 2.0),
        (8.0, 2.0),
        (12.0, 5.0),
        (20.0, 5.0),
        (21.0, 10.0),
        (28.0, 10.0),
        (40.0, 10.0),
        (0.44, 0.2),
    ],
)
def test_tick_distance_is_the_next_round_number(width: float, step: float) -> None:
    ticks = Scale(-width / 2, width / 2).ticks
    assert [round(later - earlier, 9) for earlier, later in pairwise(ticks)] == [step] * (len(ticks) - 1)
    assert ticks[0] - step < -width / 2 <= ticks[0] < 0.0 < ticks[-1] <= width / 2 < ticks[-1] + step


def test_scale_has_a_margin_at_both_ends() -> None:
    assert scale([4.0, -1.0]) == Scale(-1.25, 4.25)
    assert scale([0.0, math.inf]) == Scale(-1.0, 1.0)
    assert [Scale(-1.0, 3.0).at(value) for value in (-1.0, 0.0, 3.0)] == [0.0, 25.0, 100.0]


@pytest.mark.parametrize(
    ("bins", "outside"), [([0, 1, 2, 3], False), ([-1, 0], True), ([2, 4], True), ([0, 3, 2, 5], True)]
)
def test_axis_says_whether_values_lie_outside(bins: list[int], outside: bool) -> None:
    sensor = Sensor("x", topic="/x", field="data", low=0.0, high=8.0, bins=4, unit="m")
    words = SimpleNamespace(bin=lambda at, one: f"{at}:{one}", value=lambda *_: "value")
    axis = _axis(sensor, 3, bins, words)
    assert axis["outside"] is outside
    assert axis["title"] == "x (m)"
    assert axis["names"] == [f"3:{one}" for one in bins]
    assert axis["ticks"] is None
    assert axis["centres"] == [2.0 * one + 1.0 for one in bins]


def test_category_axis_has_a_tick_per_value() -> None:
    sensor = Sensor("mode", topic="/mode", field="data", categories=("dry", "wet"))
    words = SimpleNamespace(bin=lambda at, one: f"{at}:{one}", value=lambda at, one: f"{at}={one}")
    axis = _axis(sensor, 1, [0, 1], words)
    assert (axis["outside"], axis["title"]) == (False, "mode")
    assert axis["ticks"] == ["1=0", "1=1"]
    assert axis["centres"] == [0.0, 1.0]


def test_unknown_cells_give_a_figure_without_a_scale(two_lists):
    one = two_lists.lists[0]
    unknown = replace(one, offline=one.offline * math.nan, online=one.online * math.nan)
    found = utility_figure(two_lists, unknown)
    assert (found["range"], found["reach"]) == ([0.0, 0.0], 0.0)


def test_only_the_values_with_most_cells_get_a_row(varied):
    lane = Sensor("lane", categories=tuple("abcdefgh"))
    cells = tuple((x, value) for value in range(8) for x in range(1 + (value * 3) % 8))
    shown = plane(varied(sensors=(X, lane), cells=cells))
    assert (shown.position, shown.split) == (0, 1)
    # a to h have 1, 4, 7, 2, 5, 8, 3, 6 cells
    assert split_values(varied(sensors=(X, lane), cells=cells), shown) == [1, 2, 4, 5, 6, 7]
    equal = tuple((0, value) for value in range(8))
    assert split_values(varied(sensors=(X, lane), cells=equal), shown) == [0, 1, 2, 3, 4, 5]


def test_figures_have_five_digits_and_no_infinite_numbers():
    assert [number(value) for value in (1.2345678, -12345678.0, math.inf, math.nan)] == [
        1.2346,
        -12346000.0,
        None,
        None,
    ]


def test_repair_curves_are_named_after_the_recorded_world(varied):
    totals = dict.fromkeys(("offline", "online", "repaired", "nominal_repaired"), (1.0, 2.0))
    names = [curve["name"] for curve in reward_curves(varied(totals=totals, searches=(), permanent=True))]
    assert names == ["designed", "deployed (mud)", "repaired", "repaired, old world"]
    assert reward_curves(varied(totals=totals, searches=(), drift=None))[1]["name"] == "deployed"
