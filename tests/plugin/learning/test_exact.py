"""Statistical formulas, compared with independent computations precisely enough to detect a wrong constant."""

from __future__ import annotations

from math import comb, log
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from pytest_tarl.learning import tiles
from pytest_tarl.learning.bounds import bet_low, detectable_loss, evidence_above, rate_sequence
from pytest_tarl.learning.drift import MATERIAL, avoided, outstanding
from pytest_tarl.learning.localize import slices
from pytest_tarl.learning.student import difference_bounds, mean_bounds, student_quantile
from pytest_tarl.learning.tables import Chain

GROUPS = [
    ([1.0, 9.0, 4.0], [2.0, 2.5, 3.0, 2.2, 2.9, 2.4, 2.6]),
    ([0.0, 30.0], [1.0 + n % 5 / 10 for n in range(40)]),
    ([5.0, 5.5, 4.5, 5.1], [5.0, 5.5, 4.5, 5.1]),
    ([float(n) for n in range(30)], [n * 1e-3 for n in range(60)]),
]


@pytest.mark.parametrize("risk", [0.05, 0.001])
@pytest.mark.parametrize("number", range(len(GROUPS)))
def test_difference_interval_uses_welchs_degrees_of_freedom(number: int, risk: float) -> None:
    first, second = GROUPS[number]
    low, high = difference_bounds(first, second, risk)
    wanted = stats.ttest_ind(first, second, equal_var=False).confidence_interval(1 - 2 * risk)
    assert (low, high) == pytest.approx((wanted.low, wanted.high), rel=2e-3)


@pytest.mark.parametrize("count", [2, 3, 10, 21, 60])
def test_mean_interval_is_student_t(count: int) -> None:
    values = [float(n * n % 17) for n in range(count)]
    wanted = stats.t.interval(0.95, count - 1, np.mean(values), stats.sem(values))
    assert mean_bounds(values, 0.95) == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("degrees", [1, 1.5, 2, 5, 19.9, 20, 25, 100])
@pytest.mark.parametrize("probability", [0.6, 0.95, 0.999])
def test_quantiles_of_students_distribution_equal_the_quantiles_of_scipy(
    degrees: float, probability: float
) -> None:
    assert student_quantile(probability, degrees) == pytest.approx(
        stats.t.ppf(probability, degrees), rel=1e-3
    )


@pytest.mark.parametrize(("passed", "episodes"), [(1, 4), (18, 20), (60, 200)])
def test_evidence_at_the_bound_equals_the_threshold(passed: int, episodes: int) -> None:
    bound = rate_sequence(passed, episodes, 0.9)
    least = [log(1.0 / risk) for risk in (0.1, 0.05)]  # one bound, or two that share the risk
    below = evidence_above(passed, episodes, bound.low)
    assert min(abs(below - one) for one in least) < 1e-6 * max(least)


def test_bounds_by_betting_increase_with_the_accepted_risk() -> None:
    values = np.array([0.9, 0.8, 1.0, 0.7, 0.95] * 12)
    lows = [bet_low(values, risk) for risk in (0.2, 0.1, 0.05, 0.01)]
    assert lows == sorted(lows, reverse=True)
    assert 0.6 < lows[-1] < lows[0] < values.mean()
    assert bet_low(np.ones(1), 0.05) < 0.2


def test_detectable_loss_needs_a_significant_permutation() -> None:
    few, many = np.array([1.0, 2.0, 3.0]), np.arange(30.0)
    assert detectable_loss(few, few[:2], 1.01 / comb(5, 2)) < np.inf
    assert detectable_loss(few, few[:2], 0.99 / comb(5, 2)) == np.inf
    spread = np.sqrt(2 * many.var(ddof=1) / 30)
    wanted = (stats.norm.ppf(0.95) + stats.norm.ppf(0.8)) * spread
    assert detectable_loss(many, many, 0.05) == pytest.approx(wanted, rel=1e-9)


def world(cells_of_episodes: list[list[int]], cells: int) -> SimpleNamespace:
    pairs = [(episode, cell) for episode, visited in enumerate(cells_of_episodes) for cell in visited]
    episode, cell = (np.array(column, np.int64) for column in zip(*pairs, strict=True))
    chain = SimpleNamespace(episode=episode, cell=cell)
    return SimpleNamespace(
        chain=chain, cells=tuple((n,) for n in range(cells)), episodes=len(cells_of_episodes)
    )


@pytest.mark.parametrize("others", [0, 1, 4])
def test_avoided_cell_is_significant_after_correction(others: int) -> None:
    everyone, online = 12, 4
    off = [
        [0, 1, *range(2, 2 + others)] for _ in range(everyone - online)
    ]  # all episodes visit cell 0; only the listed episodes visit other cells
    chance = 1 / comb(
        everyone, online
    )  # probability that none of the four deployed episodes is among the eight
    alpha = chance * (1 + others)
    for factor, answer in ((1.001, True), (0.999, False)):
        found = avoided(world(off, 2 + others), world([[0]] * online, 2 + others), alpha * factor)
        assert found.tolist() == [False, *[answer] * (1 + others)]


def test_region_has_significant_cells_with_large_differences() -> None:
    difference = np.array([-10.0, 10.0 * MATERIAL, 9.99 * MATERIAL, 50.0, 0.0])
    significant = np.array([True, True, True, False, True])
    assert outstanding(difference, significant).tolist() == [True, True, False, False, False]


def test_slices_sum_cells_that_both_worlds_visited() -> None:
    nan = np.nan
    offline = np.array([[1.0, nan], [2.0, 4.0], [nan, nan], [100.0, 100.0]])
    online = np.array([[0.5, 7.0], [nan, 1.0], [3.0, 3.0], [0.0, 0.0]])
    one = SimpleNamespace(sites=("a", "b"), name="list")
    first, second = slices(one, offline, online, np.array([0, 1, 2]))  # type: ignore[arg-type]
    assert [(cut.offline, cut.online) for cut in (first, second)] == [(1.0, 0.5), (4.0, 1.0)]


@pytest.mark.parametrize("dense", [True, False])
def test_ridge_shrinks_tile_weights_by_the_expected_amount(
    dense: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not dense:
        monkeypatch.setattr(tiles, "DENSE", 0)
    count = np.array([30, 10])
    reward = np.array([60.0, -5.0])
    chain = Chain(
        episode=np.zeros(2, np.int64),
        cell=np.array([0, 1]),
        next_cell=np.full(2, -1),
        count=count,
        reward=reward,
        parts=np.zeros((2, 0)),
    )
    own = tiles.Tiles(np.array([[0], [1]]), 2)
    ridge = tiles.RIDGE * count.mean()
    wanted = reward / (count + ridge)
    assert tiles.tiled_chain(chain, 2, own) == pytest.approx(wanted, rel=1e-7)
    assert ridge > 0


def test_unvisited_cells_do_not_change_the_ridge() -> None:
    count, reward = np.array([30, 10]), np.array([60.0, -5.0])
    chain = Chain(
        episode=np.zeros(2, np.int64),
        cell=np.array([0, 1]),
        next_cell=np.full(2, -1),
        count=count,
        reward=reward,
        parts=np.zeros((2, 0)),
    )
    of_its_own = tiles.Tiles(np.arange(4)[:, np.newaxis], 4)
    found = tiles.tiled_chain(chain, 4, of_its_own)
    assert found[:2] == pytest.approx(reward / (count + tiles.RIDGE * count.mean()), rel=1e-7)
    assert np.isnan(found[2:]).all()
