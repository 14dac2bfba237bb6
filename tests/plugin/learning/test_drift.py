"""The comparison reports nothing in equal worlds, and locates a change in different ones."""

from __future__ import annotations

import numpy as np

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.bounds import detectable_loss
from pytest_tarl.learning.drift import (
    compare,
    loss_bounds,
    outstanding,
    paper_region,
)
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.permutation import max_statistic, permuted_loss
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import Sample
from pytest_tarl.seeds import generator

LENGTH = 8


def mission(seed: int, *, slow_at: int | None = None, strange: bool = False) -> Sample:
    """Walk from cell 0 to the last one; each step costs reward, and a slow cell takes more steps."""
    draws = np.random.default_rng(seed)
    path, place = [], 0
    while place < LENGTH:
        path.append(place)
        stays = 0.85 if place == slow_at else 0.3
        place += int(draws.random() > stays)
    cells = tuple((place, int(strange and place == 3)) for place in range(LENGTH))
    steps = len(path)
    trace = Trace(
        cells=cells,
        site=np.zeros(steps, np.int32),
        flow=np.ones(steps),
        event_cell=np.array(path, np.int32),
        event_step=np.arange(steps, dtype=np.int32),
        step_cell=np.array(path, np.int32),
        reward=np.append(np.full(steps - 1, -0.1), 10.0),
        parts={},
    )
    return sample(trace, seed, True, ((0,),))


def world(first: int, count: int, **drift: object) -> Sample:
    return merge([mission(seed, **drift) for seed in range(first, first + count)])  # type: ignore[arg-type]


def judged(offline: Sample, online: Sample, seed: int = 0):
    return compare(offline, online, alpha=0.05, tolerance=0.2, generator=generator(seed, "compare"))


def test_a_comparison_of_equal_worlds_rarely_reports_a_difference() -> None:
    offline = world(0, 60)
    found = [judged(offline, world(1000 + 100 * i, 20), i).verdict for i in range(40)]
    assert sum(verdict.p_drift < 0.05 for verdict in found) <= 6
    assert sum(verdict.result == "degraded" for verdict in found) <= 4


def test_slower_cell_is_degraded_and_named() -> None:
    found = judged(world(0, 60), world(1000, 30, slow_at=4))
    assert found.verdict.result == "degraded"
    assert found.verdict.p_drift < 0.01
    assert (4, 0) in found.region.cells
    assert len(found.region.cells) <= 2
    assert found.region.novel == ()


def test_an_unrecorded_cell_is_novel() -> None:
    found = judged(world(0, 60), world(1000, 30, slow_at=3, strange=True))
    assert found.region.novel == ((3, 1),)


def test_a_difference_without_a_loss_is_drifted() -> None:
    found = judged(world(0, 60), world(1000, 30, strange=True))
    assert found.verdict.result == "drifted"


def test_a_loss_within_the_tolerance_is_not_degraded() -> None:
    offline, online = world(0, 60), world(1000, 30, slow_at=4)
    found = compare(offline, online, alpha=0.05, tolerance=50.0, generator=generator(0, "compare"))
    assert found.verdict.result == "drifted"
    assert found.verdict.detectable_loss >= 50.0


def test_the_permutation_test_of_the_loss_is_one_sided() -> None:
    draws = np.random.default_rng(1)
    low, high = draws.normal(0, 1, 30), draws.normal(3, 1, 20)
    assert permuted_loss(high, low, generator(0, "a")) < 0.01
    assert permuted_loss(low, high, generator(0, "a")) > 0.9


def test_interval_covers_the_loss_with_unequal_variances() -> None:
    draws = np.random.default_rng(5)
    held = 0
    for _ in range(300):
        low, high = loss_bounds(draws.normal(1.7, 0.5, 80), draws.normal(1.0, 3.0, 12), 0.05)
        held += low <= 0.7 <= high
    assert 258 <= held <= 282  # 90 % of 300, and 2.3 binomial standard deviations on either side


def test_constant_columns_are_never_significant() -> None:
    columns = np.zeros((20, 3))
    columns[:10, 1] = 1.0
    p_values = max_statistic(columns, 10, generator(0, "a"))
    assert p_values[1] < 0.01
    assert p_values[[0, 2]].tolist() == [1.0, 1.0]


def test_paper_region_covers_half_of_the_largest_difference() -> None:
    offline = np.array([[0.0, 0.0], [1.0, 1.0], [5.0, np.nan], [1.0, 0.0]])
    online = np.array([[-4.0, 0.0], [0.0, 0.0], [np.nan, 2.0], [1.0, 0.0]])
    assert paper_region(offline, online).tolist() == [0, 1]
    assert paper_region(offline, offline).tolist() == []


def test_uncertain_difference_does_not_hide_a_certain_one() -> None:
    difference = np.array([9.0, -0.5, 0.04, 0.2])
    found = outstanding(difference, np.array([False, True, True, True]))
    assert found.tolist() == [False, True, False, True]
    assert not outstanding(difference, np.zeros(4, dtype=bool)).any()


def test_sums_that_differ_only_by_rounding_count_as_ties() -> None:
    totals = np.array([0.1, 0.2, -0.3] * 8)
    assert permuted_loss(totals, totals[:3], generator(0, "a")) > 0.3
    exact = permuted_loss(np.array([1.0, 2.0, -3.0] * 8), np.array([1.0, 2.0, -3.0]), generator(0, "a"))
    assert permuted_loss(totals, totals[:3], generator(0, "a")) == exact


def test_a_thousand_episodes_can_be_compared() -> None:
    many = np.arange(1200.0)
    assert 0.0 < detectable_loss(many, many[:1000], 0.05) < np.inf


def test_too_few_episodes_have_an_infinite_detectable_loss() -> None:
    few = np.array([1.0, 1.0])
    assert detectable_loss(few, few, 0.05) == np.inf
    assert detectable_loss(few, np.ones(40), 0.05) < np.inf


def test_two_episodes_in_each_world_show_no_difference() -> None:
    found = judged(world(0, 2), world(10, 2))
    assert found.verdict.result == "no difference"
    assert found.verdict.detectable_loss == np.inf
