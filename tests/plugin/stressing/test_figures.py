"""The map and the tornado chart of a stress run."""

from __future__ import annotations

import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest

from pytest_tarl import Drift
from pytest_tarl.spaces import Point
from pytest_tarl.stressing import page
from pytest_tarl.stressing.findings import Stress
from pytest_tarl.stressing.map_figure import COLOURS, answer, map_figure, map_words
from pytest_tarl.stressing.svg_text import INK
from pytest_tarl.stressing.tornado_figure import tornado, tornado_words
from tests.plugin.stressing.worlds import space_of, stressed


def world(point: Point, draws: np.random.Generator) -> tuple[bool, float]:
    """Lose the tolerated 0.5 where a + 0.5 b = 0.6; c does nothing."""
    return True, 10.0 - 0.5 * (point["a"] + 0.5 * point["b"]) / 0.6 + float(draws.normal(0.0, 0.05))


@cache
def found() -> Stress:
    names = {"c": 1.0, "a": 1.0, "b<&": 1.0, "b": 1.0}
    return stressed(
        world,
        space_of(**{name: Drift.range(0.0, high, nominal=0.0) for name, high in names.items()}),
        budget=700,
    )


def test_map_shows_the_two_main_directions() -> None:
    drawn = found().margin_map
    assert drawn is not None
    assert drawn.names == ("a", "b")
    count = len(drawn.margins)
    for row in range(count):
        for column in range(count):
            true = 1.0 - ((column + 0.5) + 0.5 * (row + 0.5)) / count / 0.6
            told = answer(drawn.margins[row][column], drawn.spreads[row][column])
            if abs(true) > 0.25:
                assert told in ("unsure", "holds" if true > 0.0 else "fails")
    assert "over a and b" in map_words(found())
    held = float(re.findall(r"holds in (\d+) %", map_words(found()))[0])
    assert 20 < held < 50  # the true share is 42 %, of which cells near the boundary are undecided


def test_the_tornado_has_the_most_important_direction_on_top() -> None:
    told = tornado_words(found())
    assert told.index("a: ") < told.index("b: ") < told.index("c: ")
    assert "a: 1.7 up to 1" in told
    root = ElementTree.fromstring(tornado(found()))
    assert len(root.findall("{*}rect")) == 4


def test_figures_are_well_formed_and_have_text_alternatives() -> None:
    for drawn in (map_figure(found()), tornado(found())):
        root = ElementTree.fromstring(drawn)
        assert root.get("role") == "img"
        assert len(root.get("aria-label", "")) > 40
    told = page.render(found())
    assert "<h2>Map</h2>" in told
    assert "<h2>Directions</h2>" in told


def test_one_direction_gets_neither_map_nor_tornado() -> None:
    one = stressed(lambda point, _: (point["a"] < 0.5, 1.0), space_of(a=Drift.range(0.0, 1.0, nominal=0.0)))
    assert one.margin_map is None
    assert (map_figure(one), tornado(one), map_words(one)) == ("", "", "")


def luminance(colour: str) -> float:
    parts = [int(colour[place : place + 2], 16) / 255 for place in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("background", [*COLOURS.values(), "#ffffff"])
def test_text_contrast_is_at_least_4_5(background: str) -> None:
    assert (luminance(background) + 0.05) / (luminance(INK) + 0.05) >= 4.5
