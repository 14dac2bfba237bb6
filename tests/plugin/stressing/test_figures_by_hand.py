"""The figures of a stress run, coordinate by coordinate, for curves and maps written down by hand."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree

import pytest

from pytest_tarl.spaces import Span
from pytest_tarl.stressing import map_figure, mapping, page, tornado_figure
from pytest_tarl.stressing.coordinates import Coordinates
from pytest_tarl.stressing.findings import MarginMap
from pytest_tarl.stressing.guarantee import Outcome, margin_of
from pytest_tarl.stressing.tornado_figure import tornado
from tests.plugin.stressing.test_words_by_hand import (
    DOWN,
    FLAT,
    GIVEN,
    GOOD,
    MUD,
    SPACE,
    STEEP,
    combined,
    curve,
    stress,
)

SLOPE, DEPTH = SPACE.extents["slope"], SPACE.extents["mud"]


def elements(drawn: str, kind: str) -> list[dict[str, str]]:
    """Return the attributes of the elements of a kind; the content of a text element has the key `text`."""
    root = ElementTree.fromstring(drawn)
    return [{**one.attrib, "text": one.text or ""} for one in root.findall(f".//{{*}}{kind}")]


def texts(drawn: str) -> dict[str, tuple[float, float, str]]:
    return {
        one["text"]: (float(one["x"]), float(one["y"]), one["text-anchor"]) for one in elements(drawn, "text")
    }


LOST = [
    curve(MUD, {1.0: -1.0}),
    curve(FLAT, {1.0: 0.5}),
    curve(STEEP, {0.5: -0.5, 1.0: 0.25}),
    curve(DOWN, {1.0: -1.5}),
]
UNIT = ((tornado_figure.WIDTH - tornado_figure.LABEL) / 2 - tornado_figure.END) / 2.5
MIDDLE = tornado_figure.LABEL + (tornado_figure.WIDTH - tornado_figure.LABEL) / 2


def test_bar_length_is_the_lost_margin() -> None:
    drawn = tornado(stress(*LOST))
    bars = [(float(one["x"]), float(one["width"]), float(one["y"])) for one in elements(drawn, "rect")]
    step = tornado_figure.BAR + tornado_figure.GAP
    assert bars == [
        pytest.approx((MIDDLE - 2.0 * UNIT, 2.0 * UNIT, 8), abs=0.06),  # mud, towards lower values
        pytest.approx((MIDDLE - 0.5 * UNIT, 0.5 * UNIT, 8 + step), abs=0.06),
        pytest.approx((MIDDLE, 1.5 * UNIT, 8 + step), abs=0.06),
    ]
    colours = [one["fill"] for one in elements(drawn, "rect")]
    fails, holds = (tornado_figure.COLOURS[name] for name in ("fails", "holds"))
    assert colours == [fails, holds, fails]


def test_tornado_texts_stand_at_ends_and_limits() -> None:
    drawn = tornado(stress(*LOST))
    found = texts(drawn)
    step, low = tornado_figure.BAR + tornado_figure.GAP, 8 + 2 * (tornado_figure.BAR + tornado_figure.GAP)
    base = 8 + tornado_figure.BAR - 6
    expected = {
        "mud": (tornado_figure.LABEL - 12, base, "end"),
        "slope": (tornado_figure.LABEL - 12, base + step, "end"),
        "0": (MIDDLE - 2.0 * UNIT - 6, base, "end"),
        "-1": (MIDDLE - 0.5 * UNIT - 6, base + step, "end"),
        "1": (MIDDLE + 1.5 * UNIT + 6, base + step, "start"),
        "nominal": (MIDDLE, low + 16, "middle"),
        "limit": (MIDDLE + UNIT, low + 16, "middle"),
        "← lower values": (MIDDLE - 8, low + 38, "end"),
        "higher values →": (MIDDLE + 8, low + 38, "start"),
    }
    assert {name: (x, y) for name, (x, y, _) in found.items()} == {
        name: pytest.approx((x, y), abs=0.06) for name, (x, y, _) in expected.items()
    }
    assert {name: anchor for name, (*_, anchor) in found.items()} == {
        name: anchor for name, (*_, anchor) in expected.items()
    }
    lines = [(float(one["x1"]), "stroke-dasharray" in one) for one in elements(drawn, "line")]
    assert lines == [
        (pytest.approx(MIDDLE - UNIT, abs=0.06), True),
        (pytest.approx(MIDDLE, abs=0.06), False),
        (pytest.approx(MIDDLE + UNIT, abs=0.06), True),
    ]


def test_directions_are_ranked_by_lost_margin() -> None:
    assert mapping.importance(LOST) == {"mud": 2.0, "slope": 1.5}
    assert [*mapping.importance(LOST[1:])] == ["slope"]
    assert mapping.lost(curve(MUD, {1.0: -9.0})) == 2.5
    assert mapping.lost(curve(MUD)) == 0.0
    assert [*mapping.importance([curve(FLAT, {1.0: -1.4}), LOST[0]])] == ["slope", "mud"]


class Model:
    """A prediction with margin 10 x + y and standard deviation y, for coordinates x and y."""

    def moments(self, vectors: Any) -> tuple[Any, Any]:
        return 10 * vectors[:, 0] + vectors[:, 1], vectors[:, 1]


def test_map_has_cell_middles_by_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(mapping, "CELLS", 2)
    coordinates, model = Coordinates(SPACE, SPACE.nominal), Model()
    found = mapping.margin_map(LOST, model, coordinates)  # type: ignore[arg-type]
    # the coordinates of mud are -0.75 and -0.25, those of slope -0.25 and 0.25
    assert found == MarginMap(
        ("mud", "slope"),
        (DEPTH, SLOPE),
        ((-7.75, -2.75), (-7.25, -2.25)),
        ((-0.25, -0.25), (0.25, 0.25)),  # type: ignore[arg-type]
    )
    turned = mapping.margin_map([curve(FLAT, {1.0: -1.4}), curve(MUD, {1.0: 0.5})], model, coordinates)  # type: ignore[arg-type]
    assert turned is not None
    assert (turned.names, turned.spans) == (("slope", "mud"), (SLOPE, DEPTH))
    assert turned.margins == ((-7.75, -7.25), (-2.75, -2.25))
    assert mapping.margin_map(LOST[:1], model, coordinates) is None  # type: ignore[arg-type]


SQUARE = MarginMap(
    ("mud", "slope"),
    (Span(0.0, 4.0, 4.0), Span(-1.0, 1.0, 0.0)),
    ((1.0, 1.0), (1.0, -1.0)),
    ((0.1, 0.6), (0.1, 0.1)),
)


@pytest.mark.parametrize(
    ("margin", "spread", "expected"),
    [
        (0.5, 0.25, "holds"),
        (0.5, 0.26, "unsure"),
        (-0.5, 0.25, "fails"),
        (-0.5, 0.3, "unsure"),
        (0.0, 0.0, "fails"),
    ],
)
def test_a_cell_is_undecided_within_two_standard_deviations(
    margin: float, spread: float, expected: str
) -> None:
    assert map_figure.answer(margin, spread) == expected


def test_a_map_whose_rows_lack_standard_deviations_is_neither_drawn_nor_described() -> None:
    torn = replace(SQUARE, spreads=SQUARE.spreads[:1])
    for show in (map_figure.map_figure, map_figure.map_words):
        with pytest.raises(ValueError, match="shorter"):
            show(stress(margin_map=torn))


def test_first_map_row_is_at_the_bottom() -> None:
    failures = (combined(mud=2.0, slope=0.5), combined(mud=2.0, camera=1.0))
    drawn = map_figure.map_figure(stress(margin_map=SQUARE, combinations=failures))
    cells = [
        (one["fill"], float(one["x"]), float(one["y"]), float(one["width"]))
        for one in elements(drawn, "rect")
        if "stroke" not in one
    ]
    colours = map_figure.COLOURS
    assert cells == [
        (colours["holds"], 90.0, 212.0, 200.3),
        (colours["unsure"], 290.0, 212.0, 200.3),
        (colours["holds"], 90.0, 12.0, 200.3),
        (colours["fails"], 290.0, 12.0, 200.3),
    ]
    boundary = next(one["d"] for one in elements(drawn, "path") if one.get("fill") == "none")
    assert boundary == "M290.0 212.0v-200.0M290.0 212.0h200.0"
    ring = elements(drawn, "circle")[0]
    assert (ring["cx"], ring["cy"]) == ("490.0", "212.0")
    crosses = [one["d"] for one in elements(drawn, "path") if re.match(r"M[\d.]+ [\d.]+l", one["d"])]
    assert crosses[0] == "M285.0 107.0l10 10m0 -10l-10 10"
    assert (
        len(crosses) == 2
    )  # the failure with another option lies outside the plane; the second mark belongs to the legend
    assert "holds in 50 % of the area, fails in 25 %, and is undecided in 25 %" in drawn


def test_map_labels_have_fixed_positions() -> None:
    drawn = map_figure.map_figure(stress(margin_map=SQUARE))
    found = texts(drawn)
    assert found["4"] == (490.0, 432.0, "middle")
    assert found["1"] == (82.0, 16.0, "end")
    assert found["-1"] == (82.0, 416.0, "end")
    assert found["mud"] == (290.0, 456.0, "middle")
    assert found["slope"] == (20.0, 212.0, "middle")
    assert {name: found[name][:2] for name in ("holds", "undecided", "fails")} == {
        "holds": (114.0, 491.0),
        "undecided": (244.0, 491.0),
        "fails": (374.0, 491.0),
    }
    assert [found[name][0] for name in ("predicted boundary", "nominal", "confirmed failure")] == [
        114.0,
        270.0,
        362.0,
    ]
    base = found["confirmed failure"][1]
    symbols = ("M90 514h18", 'cx="258" cy="514"', "M345 509l10 10m0 -10l-10 10")  # their middles are at 514
    assert (base, [one in drawn for one in symbols]) == (518.0, [True] * 3)
    assert map_figure.map_figure(stress()) == ""


def section(*curves: Any) -> str:
    """Return the figure of the slope."""
    whole = "".join(page._sections(stress(*curves)))
    return whole[whole.index("<svg") : whole.index("</svg>") + len("</svg>")]


def test_the_band_of_a_boundary_spans_its_interval() -> None:
    drawn = section(curve(STEEP, GOOD, confirmed=0.75, held=0.5), curve(FLAT, {1.0: 1.0}))
    width = page.WIDTH - 2 * page.EDGE
    (band,) = elements(drawn, "rect")
    assert float(band["x"]) == pytest.approx(page.EDGE + width * 0.75, abs=0.06)
    assert float(band["width"]) == pytest.approx(width * 0.125, abs=0.06)
    open_ = section(curve(FLAT, GOOD, confirmed=0.75), curve(STEEP, {1.0: 1.0}))
    (band,) = elements(open_, "rect")
    assert float(band["x"]) == pytest.approx(page.EDGE + width * 0.125, abs=0.06)
    assert float(band["width"]) == pytest.approx(width * 0.375, abs=0.06)
    assert elements(section(curve(FLAT, GOOD), curve(STEEP, {1.0: 1.0})), "rect") == []


def test_direction_line_passes_the_designed_margin() -> None:
    drawn = section(curve(FLAT, {1.0: -9.0}), curve(STEEP, {0.5: 0.0, 1.0: 9.0}))
    (line,) = elements(drawn, "polyline")
    points = [tuple(map(float, one.split(","))) for one in line["points"].split()]
    width = page.WIDTH - 2 * page.EDGE
    assert [x for x, _ in points] == pytest.approx(
        [page.EDGE + width * share for share in (0.0, 0.5, 0.75, 1.0)], abs=0.06
    )
    bottom, zero, top = (
        10 + (page.HEIGHT - 40) * (page.TOP - margin) / (page.TOP - page.BOTTOM)
        for margin in (page.BOTTOM, 0.0, page.TOP)
    )
    assert points[0][1] == pytest.approx(bottom, abs=0.06)
    assert points[2][1] == pytest.approx(zero, abs=0.06)
    assert points[3][1] == pytest.approx(top, abs=0.06)
    assert len(elements(drawn, "circle")) == 3
    assert [one["text"] for one in elements(drawn, "text")][:3] == ["-1", "0", "1"]


def test_standard_deviation_of_a_margin_is_half_its_interval() -> None:
    one = replace(GIVEN, rate=0.5, share=1.0)
    outcomes = [Outcome(True, 10.0)] * 15 + [Outcome(False, 10.0)]
    margin, deviation = margin_of(one, outcomes, [Outcome(True, 10.0)] * 16)
    assert margin == pytest.approx((15 / 16 - 0.5) / 0.5)
    # Clopper and Pearson at 10 % each: 0.7785 to 0.9934
    assert deviation == pytest.approx((0.9934 - 0.7785) / 0.5 / 2, abs=2e-3)
