"""Mixtures over bets and restarts equal the explicit sum and are e-processes, for missions in any portions."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.monitoring import e_process, restarts
from pytest_tarl.monitoring.restarts import BETS, advance, begun, log_evidence, reserve


def watched(
    factors: np.ndarray, portions: list[int] | None = None, taken: np.ndarray | None = None
) -> restarts.Processes:
    """Advance processes by factors of shape (missions, bets, processes), in portions."""
    processes = begun(np.full(factors.shape[2], np.log2(20.0)))
    taken = np.ones((len(factors), factors.shape[2]), bool) if taken is None else taken
    begin = 0
    for size in portions or [len(factors)]:
        advance(processes, taken[begin : begin + size], factors[begin : begin + size], begin)
        begin += size
    return processes


def naive(factors: np.ndarray) -> float:
    """Return the mixture of one process by its definition; factors have shape (missions, bets)."""
    count = len(factors)
    left = reserve(np.arange(count + 1))
    value = left[count]
    for start in range(count):
        value += (left[start] - left[start + 1]) * factors[start:].prod(axis=0).mean()
    return float(value)


def test_recursion_equals_the_mixture_over_restarts() -> None:
    factors = np.random.default_rng(0).uniform(0.3, 2.2, (40, BETS, 3))
    evidence = log_evidence(watched(factors))
    for process in range(3):
        assert 2.0 ** evidence[process] == pytest.approx(naive(factors[:, :, process]), rel=1e-12)


def test_the_remaining_weight_for_later_restarts_decreases_from_one() -> None:
    left = reserve(np.arange(10_000))
    assert left[0] == 1.0
    assert (np.diff(left) < 0).all()
    assert left[-1] == pytest.approx(0.5 * 9999 ** (-1 / 8))


@pytest.mark.parametrize("bound", [Fraction(1, 2), Fraction(9, 10)])
def test_alarms_at_the_bound_are_as_rare_as_alpha(
    bound: Fraction,
) -> None:
    length, alpha = 10, 0.25
    means, alarms = 0.0, 0.0
    for outcomes in product((0.0, 1.0), repeat=length):
        probability = float(np.prod([bound if one else 1 - bound for one in outcomes]))
        processes = begun(np.array([-np.log2(alpha)]))
        factors = e_process.factors(float(bound), np.array(outcomes))[:, :, None]
        advance(processes, np.ones((length, 1), bool), factors, 0)
        means += probability * 2.0 ** float(log_evidence(processes)[0])
        alarms += probability * (processes.alarm[0] >= 0)
    assert means == pytest.approx(1.0, rel=1e-9)
    assert 0 < alarms <= alpha


@given(st.lists(st.integers(1, 9), min_size=1, max_size=8), st.integers(0, 2**32 - 1))
def test_processing_in_portions_gives_bitwise_equal_results(portions: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = sum(portions)
    taken = rng.random((count, 4)) < 0.7
    factors = np.where(taken[:, None, :], np.exp2(rng.uniform(-80, 80, (count, BETS, 4))), 1.0)
    whole, parts = watched(factors, [count], taken), watched(factors, portions, taken)
    for name, column in vars(whole).items():
        np.testing.assert_array_equal(column, getattr(parts, name), err_msg=name)


def test_evidence_beyond_the_largest_float_is_kept() -> None:
    factors = np.full((400, BETS, 1), 2.0**9)
    processes = watched(factors)
    assert processes.exponent[0] > 0
    assert log_evidence(processes)[0] == pytest.approx(9 * 400 - 1, abs=0.1)
    assert processes.peak[0] == pytest.approx(log_evidence(processes)[0], rel=1e-12)


def test_onset_is_where_the_factors_changed() -> None:
    factors = np.concatenate([np.full((300, BETS, 1), 0.8), np.full((30, BETS, 1), 2.0)])
    processes = watched(factors)
    assert processes.onset.tolist() == [300]
    assert 300 < processes.alarm[0] < 330


def test_onset_is_kept_when_evidence_falls() -> None:
    parts = [(300, 0.8), (30, 2.0), (200, 0.8), (4, 2.0)]
    factors = np.concatenate([np.full((count, BETS, 1), factor) for count, factor in parts])
    for portions in ([534], [320, 7, 207], [64] * 8 + [22]):
        processes = watched(factors, portions)
        assert processes.onset.tolist() == [300]
        assert processes.since[0, 0] == 530


def test_onset_belongs_to_the_largest_term() -> None:
    factors = np.full((60, BETS, 2), 0.3)
    factors[20:40, 3, 0] = 3.0
    factors[10:50, 5, 1] = 1.8
    assert watched(factors).onset.tolist() == [20, 10]


def test_a_process_without_observations_is_unchanged() -> None:
    factors = np.ones((5, BETS, 2))
    factors[:, :, 0] = 1.5
    taken = np.zeros((5, 2), bool)
    taken[:, 0] = True
    processes = watched(factors, taken=taken)
    assert processes.age.tolist() == [5, 0]
    assert log_evidence(processes)[1] == 0.0
