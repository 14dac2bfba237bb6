"""Reward by size of a drift: the intervals in words, and a drawing with correct order and proportions."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.model import Sizes
from pytest_tarl.report import drift_sizes

ONE = Sizes("mud", 0.0, 3.0, {"online": (0.0, 0.5, 1.0, 3.0), "repaired": (2.5,)})
COMPARISON: Any = SimpleNamespace(
    sizes={"mud": ONE},
    totals={"offline": (10.0, 10.0), "online": (8.0, 6.0, 4.0, 2.0), "repaired": (9.0,)},
)


def test_each_size_belongs_to_one_interval() -> None:
    found = list(drift_sizes.rows(COMPARISON))
    assert [(row.band.low, row.band.high, row.before, row.after, row.episodes) for row in found] == [
        (0.0, 1.0, 7.0, None, (2, 0)),
        (1.0, 2.0, 4.0, None, (1, 0)),
        (2.0, 3.0, 2.0, 9.0, (1, 1)),
    ]


def test_each_line_names_an_interval_and_its_rewards() -> None:
    first, _, last = drift_sizes.lines(COMPARISON)
    assert first.startswith("mud 0 to 1: 7")
    assert last.startswith("mud 2 to 3: 2")
    assert "9" in last.partition("→")[2]
    unrepaired: Any = SimpleNamespace(sizes=COMPARISON.sizes, totals={"online": COMPARISON.totals["online"]})
    assert all("repaired" not in line for line in drift_sizes.lines(unrepaired))


def test_drawing_puts_the_highest_reward_on_top() -> None:
    (plot,) = drift_sizes.plots(COMPARISON)
    assert plot.part == "mud"
    assert plot.offline == 0.0
    assert plot.points["online"] == (
        (0.0, drift_sizes.HEIGHT / 4),
        (pytest.approx(drift_sizes.WIDTH / 6, abs=0.1), drift_sizes.HEIGHT / 2),
        (pytest.approx(drift_sizes.WIDTH / 3, abs=0.1), 3 * drift_sizes.HEIGHT / 4),
        (drift_sizes.WIDTH, drift_sizes.HEIGHT),
    )
    assert plot.points["repaired"] == (
        (pytest.approx(drift_sizes.WIDTH * 2.5 / 3, abs=0.1), drift_sizes.HEIGHT / 8),
    )
    assert [at for at, _ in plot.across] == pytest.approx([0.0, 213.3, 426.7, 640.0])
    assert [at for at, _ in plot.up] == [drift_sizes.HEIGHT, 0.0]


def test_equal_rewards_are_drawn_on_one_line() -> None:
    flat: Any = SimpleNamespace(sizes={"mud": ONE}, totals={"offline": (1.0,), "online": (1.0,) * 4})
    (plot,) = drift_sizes.plots(flat)
    assert {y for _, y in plot.points["online"]} == {0.0}


def test_range_above_zero_is_drawn_from_its_lower_end() -> None:
    worn = Sizes("worn", 0.5, 0.9, {"online": (0.5, 0.6, 0.9)})
    (plot,) = drift_sizes.plots(
        SimpleNamespace(sizes={"worn": worn}, totals={"offline": (4.0,), "online": (3.0, 2.0, 1.0)})  # type: ignore[arg-type]
    )
    assert plot.points["online"] == (
        (0.0, drift_sizes.HEIGHT / 3),
        (drift_sizes.WIDTH / 4, 2 * drift_sizes.HEIGHT / 3),
        (drift_sizes.WIDTH, drift_sizes.HEIGHT),
    )
    assert (plot.across[0], plot.across[-1]) == ((0.0, "0.5"), (drift_sizes.WIDTH, "0.9"))
    assert plot.up == ((drift_sizes.HEIGHT, "1.00"), (0.0, "4.00"))
    assert [row.band.part for row in plot.rows] == ["worn"] * 3


def test_each_drawing_has_only_the_rows_of_its_range() -> None:
    two: Any = SimpleNamespace(
        sizes={"mud": ONE, "worn": Sizes("worn", 0.5, 0.9, {"online": (0.5, 0.6, 0.7, 0.9)})},
        totals=COMPARISON.totals,
    )
    assert [{row.band.part for row in plot.rows} for plot in drift_sizes.plots(two)] == [{"mud"}, {"worn"}]


def test_designed_line_without_totals_is_at_zero() -> None:
    only: Any = SimpleNamespace(sizes={"mud": ONE}, totals={"online": (4.0, 3.0, 2.0, 1.0)})
    (plot,) = drift_sizes.plots(only)
    assert plot.offline == drift_sizes.HEIGHT
    assert [label for _, label in plot.up] == ["0.00", "4.00"]
