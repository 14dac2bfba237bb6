"""Reward by size of a drift: the intervals in words, and a drawing with correct order and proportions."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Sizes
from pytest_tarl.report import sizes

ONE = Sizes("mud", 0.0, 3.0, {"online": (0.0, 0.5, 1.0, 3.0), "repaired": (2.5,)})
COMPARISON: Any = SimpleNamespace(
    sizes={"mud": ONE},
    totals={"offline": (10.0, 10.0), "online": (8.0, 6.0, 4.0, 2.0), "repaired": (9.0,)},
)


def test_each_size_belongs_to_one_interval_and_the_last_one_includes_its_end() -> None:
    found = list(sizes.rows(COMPARISON))
    assert [(row.band.low, row.band.high, row.before, row.after, row.episodes) for row in found] == [
        (0.0, 1.0, 7.0, None, (2, 0)),
        (1.0, 2.0, 4.0, None, (1, 0)),
        (2.0, 3.0, 2.0, 9.0, (1, 1)),
    ]


def test_words_name_the_interval_and_the_rewards() -> None:
    first, _, last = sizes.lines(COMPARISON)
    assert first.startswith("mud 0 to 1: 7")
    assert last.startswith("mud 2 to 3: 2")
    assert "9" in last.partition("→")[2]
    unrepaired: Any = SimpleNamespace(sizes=COMPARISON.sizes, totals={"online": COMPARISON.totals["online"]})
    assert all("repaired" not in line for line in sizes.lines(unrepaired))


def test_the_drawing_puts_the_highest_reward_on_top_and_the_range_across_its_width() -> None:
    (plot,) = sizes.plots(COMPARISON)
    assert plot.part == "mud"
    assert plot.offline == 0.0
    assert plot.points["online"] == (
        (0.0, sizes.HEIGHT / 4),
        (pytest.approx(sizes.WIDTH / 6, abs=0.1), sizes.HEIGHT / 2),
        (pytest.approx(sizes.WIDTH / 3, abs=0.1), 3 * sizes.HEIGHT / 4),
        (sizes.WIDTH, sizes.HEIGHT),
    )
    assert plot.points["repaired"] == ((pytest.approx(sizes.WIDTH * 2.5 / 3, abs=0.1), sizes.HEIGHT / 8),)
    assert [at for at, _ in plot.across] == pytest.approx([0.0, 213.3, 426.7, 640.0])
    assert [at for at, _ in plot.up] == [sizes.HEIGHT, 0.0]


def test_equal_rewards_are_drawn_on_one_line() -> None:
    flat: Any = SimpleNamespace(sizes={"mud": ONE}, totals={"offline": (1.0,), "online": (1.0,) * 4})
    (plot,) = sizes.plots(flat)
    assert {y for _, y in plot.points["online"]} == {0.0}
