"""Bounds agree with their definitions, have their stated coverage, and refuse invalid input."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import example, given, settings

from pytest_tarl.learning.binomial import BinomialTail
from pytest_tarl.learning.bounds import (
    Range,
    bet_low,
    episodes_for_quantile,
    evidence_above,
    loss_between,
    mean_of,
    quantile_low,
    rate,
    rate_low,
    rate_sequence,
)

CONFIDENCES = st.sampled_from([0.8, 0.9, 0.95, 0.99, 0.9999])


@pytest.mark.parametrize(
    (
        "passed",
        "episodes",
        "low",
        "high",
    ),  # scipy.stats.beta.ppf(0.05, s, n - s + 1), ppf(0.95, s + 1, n - s)
    [
        (200, 200, 0.9851329607687279, 1.0),
        (199, 200, 0.9765015295650495, 0.9997435664127765),
        (7, 8, 0.5293205913988683, 0.993608849045455),
        (50, 100, 0.41362171463091174, 0.5863782853690888),
        (0, 5, 0.0, 0.450719728346941),
    ],
)
def test_bounds_of_a_rate_are_quantiles_of_beta_distributions(
    passed: int, episodes: int, low: float, high: float
) -> None:
    found = rate(passed, episodes, 0.95)
    assert (found.low, found.high) == pytest.approx((low, high), abs=1e-12)
    assert found.exact


@given(st.integers(1, 400), st.integers(0, 400), CONFIDENCES)
@settings(deadline=None)
def test_bounds_equal_the_bounds_that_scipy_computes(episodes: int, passed: int, confidence: float) -> None:
    beta = pytest.importorskip("scipy.stats").beta
    passed = min(passed, episodes)
    low = float(beta.ppf(1 - confidence, passed, episodes - passed + 1)) if passed else 0.0
    assert rate_low(passed, episodes, 1 - confidence) == pytest.approx(low, abs=1e-9)


@given(st.integers(1, 60), st.integers(0, 60), st.floats(0.001, 0.999))
@settings(deadline=None)
def test_a_binomial_tail_is_the_sum_of_its_terms(n: int, k: int, p: float) -> None:
    k = min(k, n)
    terms = [math.comb(n, j) * p**j * (1 - p) ** (n - j) for j in range(k + 1)]
    assert BinomialTail(k, n)(p) == pytest.approx(math.fsum(terms), abs=1e-12)


@given(st.integers(1, 30), st.integers(0, 30), st.floats(0.01, 0.99))
@settings(deadline=None)
def test_evidence_mixes_likelihood_ratios_of_higher_rates(n: int, passed: int, least: float) -> None:
    passed = min(passed, n)
    rates = least + (1 - least) * (np.arange(20_000) + 0.5) / 20_000
    ratio = (rates / least) ** passed * ((1 - rates) / (1 - least)) ** (n - passed)
    assert math.exp(evidence_above(passed, n, least)) == pytest.approx(
        float(ratio.mean()), rel=1e-4, abs=1e-12
    )


@given(st.integers(0, 2**20), st.floats(0.2, 0.98), st.floats(0.2, 0.98))
@settings(deadline=None)
def test_expected_evidence_does_not_grow_at_lower_rates(seed: int, least: float, part: float) -> None:
    p, n = least * part, int(np.random.default_rng(seed).integers(0, 12))
    for passed in range(n + 1):
        now = math.exp(evidence_above(passed, n, least)) if n else 1.0
        after = p * math.exp(evidence_above(passed + 1, n + 1, least)) + (1 - p) * math.exp(
            evidence_above(passed, n + 1, least)
        )
        assert after <= now * (1 + 1e-9)


@given(st.integers(1, 300), st.integers(0, 300), CONFIDENCES)
@settings(deadline=None)
def test_anytime_bounds_are_wider_than_fixed_bounds(episodes: int, passed: int, confidence: float) -> None:
    passed = min(passed, episodes)
    always, once = rate_sequence(passed, episodes, confidence), rate(passed, episodes, confidence)
    assert 0.0 <= always.low <= once.low + 1e-9
    assert once.high - 1e-9 <= always.high <= 1.0


@given(
    st.lists(st.floats(0, 1), min_size=1, max_size=60),
    st.floats(-100, 100),
    st.floats(0.01, 100),
    CONFIDENCES,
    st.booleans(),
)
@example([0.0] * 3 + [1.0] * 3, 0.0, 1.0, 0.8, False)
@settings(deadline=None)
def test_bounds_of_a_mean_scale_with_the_reward_unit(
    shares: list[float], low: float, width: float, confidence: float, anytime: bool
) -> None:
    totals = [low + width * share for share in shares]
    declared = Range(low, max(low + width, *totals))
    found = mean_of(totals, confidence, declared, anytime=anytime)
    assert declared.low - 1e-9 <= found.low <= float(np.mean(totals)) + 1e-9
    assert float(np.mean(totals)) - 1e-9 <= found.high <= declared.high + 1e-9
    unit = mean_of(shares, confidence, Range(0, 1), anytime=anytime)
    assert found.low == pytest.approx(low + width * unit.low, abs=1e-6 * width)


def test_a_total_outside_the_declared_range_is_refused() -> None:
    with pytest.raises(ValueError, match="outside 0 to 1"):
        mean_of([0.5, 1.5], 0.95, Range(0, 1))


def test_more_episodes_give_tighter_bounds() -> None:
    values = np.tile([0.4, 0.6, 0.5, 0.8, 0.3], 80)
    bounds = [bet_low(values[:n], 0.05) for n in (5, 20, 100, 400)]
    assert bounds == sorted(bounds)
    assert values.mean() - bounds[-1] < 0.03


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=200), st.floats(0.01, 0.5), CONFIDENCES)
@settings(deadline=None)
def test_quantile_needs_enough_episodes(totals: list[float], share: float, confidence: float) -> None:
    low = quantile_low(totals, share, confidence)
    assert (low is None) == (len(totals) < episodes_for_quantile(share, confidence))
    if low is not None:
        rank = sorted(totals).index(low)  # number of totals below it
        assert BinomialTail(rank, len(totals))(share) <= 1 - confidence + 1e-12 or totals.count(low) > 1


@pytest.mark.parametrize("draw", ["normal", "exponential", "lognormal"])
def test_shift_bounds_cover_skewed_totals(
    draw: str,
) -> None:
    held = np.zeros(2)
    for seed in range(150):
        draws = np.random.default_rng(seed)
        totals = [getattr(draws, draw)(size=size) for size in (60, 8)]
        found = loss_between(totals[0].tolist(), (totals[1] - 2.0).tolist(), 0.9)
        held += found.low <= 2.0, found.high >= 2.0
    assert (held >= 0.9 * 150 - 2.5 * math.sqrt(150 * 0.09)).all()
    assert (held < 150).all()


def test_loss_bound_in_a_declared_range_adds_both_bounds() -> None:
    found = loss_between([0.9] * 50, [0.1] * 50, 0.95, Range(0, 1))
    assert found.exact
    assert 0.6 < found.low < 0.8 <= found.high


def test_two_episodes_give_no_bound() -> None:
    assert loss_between([1.0, 2.0], [1.0, 2.0], 0.95).low == -math.inf
    never = loss_between([3.0] * 20, [3.0] * 8, 0.95)
    assert never.low == never.high == 0.0


@given(st.integers(0, 2**20), st.sampled_from([1e-200, 1e-3, 1e3, 1e100]))
@settings(deadline=None, max_examples=15)
def test_loss_bounds_scale_with_the_reward_unit(seed: int, unit: float) -> None:
    draws = np.random.default_rng(seed)
    before, after = draws.normal(size=30), draws.normal(size=10)
    one = loss_between(before.tolist(), after.tolist(), 0.9)
    other = loss_between((unit * before).tolist(), (unit * after).tolist(), 0.9)
    assert other.low / unit == pytest.approx(one.low, rel=1e-6)
    assert other.high / unit == pytest.approx(one.high, rel=1e-6)
