"""Tests of a chain that count failures, and run the seeds first that failed under the drift before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.spaces import Point
from pytest_tarl.stressing.evaluating import Count
from pytest_tarl.stressing.guarantee import Guarantee, Outcome, most_passed
from pytest_tarl.stressing.rate_tests import LOOKS, SPENT, RateTests

GIVEN = Guarantee(0.95, 0.5, (1.0,) * 100, 1.0)


@dataclass
class Episodes:
    """An evaluator of a world whose episodes fail by `rate` and a number of the seed, which `alike` drifts share."""

    seed: int
    alike: float  # share of the seeds whose luck is the same under all drifts
    guarantee: Guarantee = GIVEN
    ran: list[tuple[float, int]] = field(default_factory=list)
    counts: list[Count] = field(default_factory=list)

    def fails(self, rate: float, row: int) -> bool:
        common = np.random.default_rng([self.seed, row]).random(2)
        own = np.random.default_rng([self.seed, row, round(1e6 * rate)]).random()
        return bool((common[0] if common[1] < self.alike else own) < rate)

    def ordered(self, _: str, point: Point, rows: Sequence[int]) -> dict[int, Outcome]:
        self.ran += [(point["rate"], row) for row in rows]
        return {row: Outcome(not self.fails(point["rate"], row), 1.0) for row in rows}

    def count(self, _: str, count: Count) -> None:
        self.counts.append(count)


def confirmed(episodes: Any, rates: Sequence[float], risk: float) -> list[float]:
    """Return the failure rates of the confirmed drifts of a chain."""
    tests, found = RateTests(episodes, "fresh", risk), []
    for rate in rates:
        if not tests.confirm({"rate": rate}):
            break
        found.append(rate)
    return found


def least(size: int, risk: float) -> int:
    return size - most_passed(GIVEN, size, risk, "rate")


@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.5, 1.0]),
    st.lists(st.floats(0.02, 0.9), min_size=1, max_size=5),
)
@settings(max_examples=60, deadline=None)
def test_confirmed_drift_needs_all_seeds(seed: int, alike: float, rates: list[float]) -> None:
    episodes = Episodes(seed, alike)
    for rate in confirmed(episodes, rates, 0.05):
        failed = [episodes.fails(rate, row) for row in range(LOOKS[-1])]
        assert any(
            sum(failed[:size]) >= least(size, 0.05 * share) for size, share in zip(LOOKS, SPENT, strict=True)
        )
    for rate in rates:
        rows = [row for at, row in episodes.ran if at == rate]
        assert len(rows) == len(set(rows)) or rates.count(rate) > 1


@pytest.mark.parametrize("alike", [0.0, 0.5, 1.0])
def test_chains_rarely_confirm_the_guaranteed_rate(alike: float) -> None:
    runs, risk = 300, 0.1
    wrong = sum(
        len(confirmed(Episodes(seed, alike), (0.5, 0.3, 0.0501, 0.05, 0.0499), risk)) > 2
        for seed in range(runs)
    )
    assert wrong <= risk * runs + 3.0 * (risk * (1.0 - risk) * runs) ** 0.5


def test_further_drifts_take_few_episodes_on_failed_seeds() -> None:
    def spent(alike: float) -> int:
        every = [Episodes(seed, alike) for seed in range(20)]
        whole = [one for one in every if confirmed(one, (0.6, 0.36, 0.34), 0.05) == [0.6, 0.36, 0.34]]
        assert len(whole) > 10
        return sum(at == 0.34 for one in whole for at, _ in one.ran) // len(whole)

    assert spent(1.0) < 0.6 * spent(0.0)


def test_seed_order_does_not_bias_the_learned_rate() -> None:
    for alike in (0.0, 1.0):
        shares = []
        for seed in range(40):
            episodes = Episodes(seed, alike)
            confirmed(episodes, (0.5, 0.3), 0.05)
            shares += [one.failed / one.episodes for one in episodes.counts if one.point["rate"] == 0.3]
        assert np.mean(shares) == pytest.approx(0.3, abs=0.06)


def test_interim_checks_share_the_risk() -> None:
    assert sum(SPENT) == pytest.approx(1.0)
    assert len(SPENT) == len(LOOKS)
    assert list(LOOKS) == sorted(LOOKS)
