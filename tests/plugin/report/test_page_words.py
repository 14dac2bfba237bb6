"""Sentences and figures of the page, without writing the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from pytest_tarl.model import Comparison, Region
from pytest_tarl.report import html, sensor_regions, words
from pytest_tarl.sensors import Sensor
from tests.plugin.report.conftest import LIGHT, TERRAIN, X

Varied = Callable[..., Comparison]


@pytest.mark.parametrize(
    ("totals", "share"),
    [
        ({"offline": (10.0,), "online": (2.0,), "repaired": (8.0,)}, 75.0),
        ({"offline": (10.0,), "online": (2.0,), "repaired": (0.0,)}, -25.0),
        ({"offline": (2.0,), "online": (2.0,), "repaired": (8.0,)}, None),
        ({"offline": (1.0,), "online": (2.0,), "repaired": (8.0,)}, None),
        ({"offline": (10.0,), "online": (2.0,)}, None),
        ({"offline": (10.0,), "repaired": (8.0,)}, None),
        ({"online": (2.0,), "repaired": (8.0,)}, None),
    ],
)
def test_the_restored_share_is_relative_to_the_lost_reward(
    varied: Varied, totals: dict[str, tuple[float, ...]], share: float | None
) -> None:
    assert html._share(varied(totals=totals)) == share


@pytest.mark.parametrize(
    ("curves", "clipped"),
    [
        ([("offline", 3), ("online", 2)], True),
        ([("offline", 2), ("online", 2)], False),
        ([("offline", 3), ("online", 2), ("repaired", 4)], False),
        ([("offline", 3)], False),
        ([("online", 3)], False),
    ],
)
def test_longest_designed_curve_is_clipped(curves: list[tuple[str, int]], clipped: bool) -> None:
    assert html._clipped([{"kind": kind, "mean": [0.0] * count} for kind, count in curves]) is clipped


def figure(outside: bool = False) -> dict[str, Any]:
    return {
        "axis": {"outside": outside, "names": ["x 0-1 m", "x 1-2 m"]},
        "sites": [[3, "a = 1", "n.py"], [4, "b = [\n  2]", "n.py"]],
        "rows": [
            {"title": "", "offline": [[1.0, None], [2.0, 5.0]], "online": [[2.5, 9.0], [None, 2.5]]},
            {"title": "wet", "offline": [[1.0, 1.0], [0.0, 0.0]], "online": [[1.0, 3.0], [1.0, -1.0]]},
        ],
    }


def test_largest_change_is_named_with_line_and_row() -> None:
    told = html._largest_change(figure())
    assert told == "The largest change, −2.50, is at x 1–2 m, in line 4 (“b = [ 2]”)."
    second = figure()
    second["rows"] = second["rows"][1:]
    assert (
        html._largest_change(second) == "The largest change, +2.00, is at x 1–2 m, wet, in line 3 (“a = 1”)."
    )
    assert html._largest_change(second | {"rows": []}) == "No cell was visited in both worlds."


def test_captions_say_what_a_figure_averages(varied: Varied) -> None:
    many = Sensor("lane", categories=tuple("abcdefgh"))
    seven = tuple((0, value, 0) for value in range(7))
    one = varied(sensors=(X, many, TERRAIN), cells=seven, region=Region(seven[:1]))
    assert list(html._captions(one, figure(outside=True))) == [
        "Each value is the mean over terrain.",
        "Only the 6 most frequent values of lane are shown.",
        "The outermost columns hold all values beyond the range.",
    ]
    few = varied(sensors=(X, many), cells=tuple((0, value) for value in range(6)), region=Region())
    assert list(html._captions(few, figure())) == []


def test_curves_are_described_by_their_last_value() -> None:
    curves = [{"name": "designed", "mean": [1.0, -2.5]}, {"name": "deployed", "mean": [3.0]}]
    assert html._curves_in_words(curves) == "designed −2.50 after 2 episodes; deployed 3.00 after 1 episodes"


def test_data_in_a_script_cannot_close_it() -> None:
    assert html.in_script({"a": "</script><!--", "ü": 1.5}).count("<") == 0
    with pytest.raises(ValueError, match="JSON"):
        html.in_script(float("nan"))


def test_paths_and_test_ids_break_at_their_parts() -> None:
    assert html.parts("tests/test_a.py::test_b[c]") == ["tests/", "test_", "a.", "py::", "test_", "b[c]"]


@pytest.mark.parametrize(
    ("cover", "joined"),
    [
        ([((0, 0),), ((2, 3),)], [((2, 4),)]),
        ([((0, 1),), ((3, 3),)], [((3, 5),)]),
        ([((1, 1),), ((3, 3),)], [((1, 1),), ((3, 3),)]),
        ([((0, 0),), ((2, 2),)], [((0, 0),), ((2, 2),)]),
        ([((0, 3),)], [((0, 3),)]),
        ([((1, 3),)], [((1, 3),)]),
    ],
)
def test_boxes_of_an_angle_meet_at_its_ends(
    cover: list[sensor_regions.Box], joined: list[sensor_regions.Box]
) -> None:
    assert list(sensor_regions.closed(cover, 0, 4)) == joined


def test_boxes_are_joined_over_unvisited_cells_only() -> None:
    low, high = ((1, 2), (5, 6)), ((4, 4), (3, 5))
    assert sensor_regions.bridged([low, high], []) == (((1, 4), (3, 6)),)
    assert sensor_regions.bridged([high, low], [(1, 2), (5, 4)]) == (((1, 4), (3, 6)),)
    for corner in ((1, 3), (4, 6), (3, 4)):
        assert sensor_regions.bridged([low, high], [corner]) == (low, high)


def test_ranges_are_joined_if_they_touch_or_overlap() -> None:
    assert sensor_regions.runs([(5, 5), (1, 2), (3, 3), (7, 9), (8, 8)]) == [(1, 3), (5, 5), (7, 9)]


def test_wide_line_is_cut_but_never_below_sixteen_characters() -> None:
    code = "0123456789" * 4
    assert words.one_line(code, 40) == code
    assert words.one_line(code, 39) == code[:38] + "…"
    assert words.one_line(code[:16], 5) == code[:16]
    assert words.one_line("ab " * 10, 21) == "ab ab ab ab ab ab ab…"
    assert words.one_line(code) == code


def test_new_situations_are_described_separately_from_known_situations(
    two_lists: Comparison, varied: Varied
) -> None:
    assert "; not in the recording: " in words.region_words(two_lists)
    region = two_lists.region
    for changed, said in (
        ({"novel": ()}, "x 1.2-8.8 m, light dusk <&>"),
        (
            {"cells": (), "novel": ((3, 0, 2),)},
            "not in the recording: x 1.2-1.7 m, terrain false, light night",
        ),
        (
            {"cells": (), "novel": (), "left": ((3, 0, 0),)},
            "no longer visited: x 1.2-1.7 m, terrain false, light day",
        ),
        ({"novel": (), "without": (2,)}, "x 1.2-8.8 m, regardless of light"),
        ({"cells": (), "novel": (), "without": (2,)}, ""),
    ):
        made = Region(**{"cells": region.cells, **changed})
        one = varied(sensors=(X, TERRAIN, LIGHT), cells=two_lists.cells, region=made)
        assert words.region_words(one) == said
