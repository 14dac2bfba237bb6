"""Known variance components are estimated with intervals that contain them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pytest_tarl.fleet import components as module
from pytest_tarl.fleet import decomposition
from pytest_tarl.fleet.components import Component, components
from pytest_tarl.fleet.decomposition import Decomposition, summed
from pytest_tarl.fleet.decomposition_words import lines, lowest
from pytest_tarl.learning.tables import Floats, Ints
from tests.slow import SLOW

NAMES = ("version", "site", "season")
SIZES = (3, 8, 5)


def missions(seed: int, robots: int, each: int, scale: float) -> tuple[Ints, Ints, Floats, list[float]]:
    """Draw a fleet with a staged rollout; return robot, levels and reward of each mission, and the true components."""
    rng = np.random.default_rng(seed)
    effects = [_effects(rng, size, scale * s) for size, s in zip(SIZES, (0.3, 0.4, 0.2), strict=True)]
    robot, number = np.repeat(np.arange(robots), each), np.tile(np.arange(each), robots)
    site, season = robot % SIZES[1], number * SIZES[2] // each
    early = (site % 3 == 0) & (number > each // 2)
    version = np.minimum(number * SIZES[0] // each + early, SIZES[0] - 1)
    levels = np.stack([version, site, season], axis=1)
    kept = rng.random(robot.size) < rng.uniform(0.4, 1.0, robots)[robot]  # some robots work more than others
    fixed = sum(effect[column] for effect, column in zip(effects, levels.T, strict=True))
    reward = 5.0 + fixed + rng.normal(0, 0.5 * scale, robots)[robot] + rng.normal(0, 1, robot.size)
    levels = levels[kept]
    truth = [float(np.var(effect[column])) for effect, column in zip(effects, levels.T, strict=True)]
    return robot[kept], levels, reward[kept], [*truth, (0.5 * scale) ** 2, 1.0]


def _effects(rng: np.random.Generator, size: int, spread: float) -> Floats:
    drawn = rng.normal(size=size)
    return (drawn - drawn.mean()) / drawn.std() * spread


def found(seed: int, robots: int, each: int, scale: float) -> tuple[tuple[Component, ...], list[float]]:
    robot, levels, reward, truth = missions(seed, robots, each, scale)
    totals = summed(robot, levels, reward - reward.mean(), SIZES)
    return components(totals, NAMES, 0.95, np.random.default_rng(seed)), truth


def coverage(runs: int, robots: int, each: int, scale: float) -> tuple[Floats, Floats, Floats]:
    """Return the share of intervals that contain the true value, and the mean and standard deviation of the errors."""
    held, away = [], []
    for seed in range(runs):
        every, truth = found(seed, robots, each, scale)
        held.append([one.low <= value <= one.high for one, value in zip(every, truth, strict=True)])
        away.append([one.variance - value for one, value in zip(every, truth, strict=True)])
    return np.mean(held, axis=0), np.mean(away, axis=0), np.std(away, axis=0)


def test_the_intervals_contain_the_known_variance_components() -> None:
    held, mean, spread = coverage(7, 60, 20, 1.0)
    assert held.mean() >= 0.85  # 35 intervals at 95 %
    assert np.all(np.abs(mean) <= 6 * spread / np.sqrt(7))


@pytest.mark.skipif(not SLOW, reason="takes a minute; set TARL_SLOW=1")
@pytest.mark.parametrize("scale", [1.0, 0.2, 0.0])
@pytest.mark.parametrize(("robots", "each"), [(60, 30), (200, 40)])
def test_intervals_contain_simulated_components_often_enough(robots: int, each: int, scale: float) -> None:
    held, mean, spread = coverage(200, robots, each, scale)
    assert np.all(held >= 0.85)
    assert np.all(np.abs(mean) <= 4 * spread / np.sqrt(200) + 1e-12)


def test_balanced_missions_give_the_analysis_of_variance() -> None:
    rng = np.random.default_rng(5)
    robot = np.repeat(np.arange(40), 25)
    reward = rng.normal(0, 1, 1000) + rng.normal(0, 0.7, 40)[robot]
    totals = summed(robot, np.zeros((1000, 1), np.int64), reward - reward.mean(), (1,))
    _, between, within = components(totals, ("site",), 0.95, rng)
    table = reward.reshape(40, 25)
    expected = float(table.var(axis=1, ddof=1).mean())
    assert within.variance == pytest.approx(expected)
    assert between.variance == pytest.approx(float(table.mean(axis=1).var(ddof=1)) - expected / 25)


def test_the_effects_of_a_factor_are_relative_to_the_mean_over_missions() -> None:
    """Of 12 missions, 2, 4 and 6 have the sites 0, 1 and 2, which earn 0, 3 and 9: 5.5 on average.

    Three of them, one at each site, are in a season that earns 4 more.
    """
    site = np.repeat([0, 1, 2], [2, 4, 6])
    season = np.isin(np.arange(12), [0, 2, 6]).astype(int)
    reward = np.array([0.0, 3.0, 9.0])[site] + 4.0 * season
    totals = summed(np.arange(12) % 4, np.stack([site, season], axis=1), reward, (3, 2))
    sites, seasons, *_ = components(totals, ("site", "season"), 0.95, np.random.default_rng(0))
    assert sites.effects == pytest.approx((-5.5, -2.5, 3.5))
    assert seasons.effects == pytest.approx((-1.0, 3.0))
    assert sites.variance == pytest.approx(float(np.var(np.array([0.0, 3.0, 9.0])[site])))


def test_effects_of_coinciding_factors_cannot_be_separated() -> None:
    robot, levels, reward, _ = missions(1, 40, 20, 1.0)
    levels[:, 0] = levels[:, 2] >= 2
    totals = summed(robot, levels, reward, (2, *SIZES[1:]))
    version, site, season, *others = components(totals, NAMES, 0.95, np.random.default_rng(0))
    assert np.isnan(version.variance)
    assert np.isnan(season.variance)
    assert site.low < site.variance < site.high
    said = [
        *lines(
            Decomposition(
                "month", (version, site, season, *others), (("a", "b"), tuple("cdefghij"), tuple("klmno"))
            )
        )
    ]
    assert said[1] == "  version         cannot be told apart from the others"
    assert "season (month)" in said[3]


def test_missions_without_a_repair_are_a_level_of_their_own() -> None:
    repair = Component("repair", 0.5, 0.1, 0.9, 2, effects=(-0.25, 0.25))
    assert lowest(repair, ("", "guard-1")) == "no repair -0.25"


def test_with_few_robots_a_component_has_no_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "FEWEST", 50)
    every, _ = found(0, 40, 20, 1.0)
    assert {(one.low, one.high) for one in every} == {(0.0, float("inf"))}
    said = [
        *lines(
            Decomposition(
                "week", tuple(replace(one, levels=9) for one in every), (("v",) * 3, ("s",) * 8, ("w",) * 5)
            )
        )
    ]
    assert all("too few robots for an interval" in one for one in said[1:])


@pytest.mark.parametrize(
    ("value", "replicates", "interval"),
    [
        # percentiles 1 and 3, shifted by 2, and scaled by 4 / 2
        (4.0, [0.0, 1.0, 2.0, 3.0, 4.0], (1.0, 6.0)),
        # percentiles 0.5 and 1.5, shifted by 3, and scaled by 4
        (4.0, [0.0, 0.5, 1.0, 1.5, 2.0], (0.5, 6.0)),
        # percentiles 1 and 3, shifted by -1, and not scaled
        (1.0, [0.0, 1.0, 2.0, 3.0, 4.0], (0.0, 3.0)),
        (2.0, [0.0, 1.0, 2.0, 3.0, 4.0], (1.0, 3.0)),
        # percentiles -1 and 1, shifted by 0.2; replicates with the mean 0 cannot be scaled
        (0.2, [-2.0, -1.0, 0.0, 1.0, 2.0], (0.0, 1.2)),
        (0.5, [-3.0, -2.0, -1.0, 0.0, 1.0], (0.0, 1.5)),
        # all positive: 3 divided by the percentiles 4 and 2 of the ratio to the mean 3
        (3.0, [1.0, 2.0, 4.0, 4.0, 4.0], (2.25, 4.5)),
        (0.0, [1.0, 2.0, 4.0, 4.0, 4.0], (0.0, 4.0)),
    ],
)
def test_component_interval_spans_shifted_percentiles(
    value: float, replicates: list[float], interval: tuple[float, float]
) -> None:
    columns = np.array([[1.0] * 5, replicates, [1.0] * 5]).T
    fit = module._Fit(np.array([1.0, value, 1.0]), np.zeros(3), np.zeros(0))
    low, high = module._interval(fit, columns, 0.5)
    assert (low[1], high[1]) == pytest.approx(interval)


def test_factor_interval_loses_the_error_part() -> None:
    columns = np.array([[0.0, 1.0, 2.0, 3.0, 4.0], [1.0] * 5, [1.0] * 5]).T
    fit = module._Fit(np.array([2.0, 1.0, 1.0]), np.array([1.5, 9.0, 9.0]), np.zeros(0))
    low, high = module._interval(fit, columns, 0.5)
    assert (low[0], high[0]) == pytest.approx((0.0, 1.5))


@pytest.mark.parametrize(
    ("months", "repairs", "season", "factors"),
    [
        (2, 1, "week", ["version", "site", "season"]),
        (3, 1, "month", ["version", "site", "season"]),
        (3, 2, "month", ["version", "site", "season", "repair"]),
        (0, 0, "week", ["version", "site", "season"]),
    ],
)
def test_three_months_make_seasons_a_factor(
    months: int, repairs: int, season: str, factors: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    counts = {decomposition.BY["month"]: months, decomposition.BY["repair"]: repairs}
    asked: list[str] = []

    def names(query: str) -> list[tuple[object, ...]]:
        for column, count in counts.items():
            if query == decomposition.COUNT.format(column=column):
                return [(count,)]
        return [(name,) for name in (1, "b")]

    def found(totals: object, columns: tuple[str, ...], *_: object) -> tuple[()]:
        asked.extend(columns)
        assert totals == (factors, (2,) * len(factors))
        return ()

    monkeypatch.setattr(decomposition, "_totals", lambda _, columns, sizes: ([*columns], sizes))
    monkeypatch.setattr(decomposition, "components", found)
    database: Any = SimpleNamespace(run=lambda _: None, names=names)
    result = decomposition.decomposed(database)
    assert (result.season, asked, result.levels) == (season, factors, (("1", "b"),) * len(factors))
