"""The Gaussian processes of the stress search agree with closed forms, other solvers and generated data."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from threadpoolctl import threadpool_info, threadpool_limits

from pytest_tarl.stressing.one_thread import _libraries, one_thread
from pytest_tarl.stressing.surrogates import (
    LossField,
    Matrix,
    RateField,
    covariance,
    variance,
)

USUAL = -4.0  # logit of the failing share at nominal


def drifts(seed: int, count: int = 30, directions: int = 2) -> Matrix:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, directions))


@given(st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_the_prior_is_a_covariance_that_vanishes_at_nominal(seed: int) -> None:
    vectors = drifts(seed, 12, 3)
    found = covariance(vectors, vectors)
    assert np.diag(found) == pytest.approx(variance(vectors))
    assert np.linalg.eigvalsh(found).min() > -1e-9
    nominal = np.zeros((1, 3))
    assert covariance(nominal, vectors) == pytest.approx(np.zeros((1, 12)))
    assert variance(nominal) == pytest.approx([0.0])


def test_loss_is_interpolated_or_smoothed() -> None:
    vectors = drifts(0)
    losses = vectors @ np.array([0.7, -0.2]) + 0.5 * vectors[:, 0] ** 2
    prior = covariance(vectors, vectors)
    exact = LossField(prior, losses, 1e-8 * np.eye(len(losses)))
    means, deviations = exact.moments(prior, variance(vectors))
    assert means == pytest.approx(losses, abs=1e-4)
    assert deviations.max() < 0.01
    rough = LossField(prior, losses, 1e6 * np.eye(len(losses)))
    means, deviations = rough.moments(prior, variance(vectors))
    assert np.abs(means).max() < 0.01  # nothing learned: the prior
    assert deviations == pytest.approx(np.sqrt(variance(vectors)), rel=1e-3)


def test_evidence_is_a_normal_density() -> None:
    vectors = drifts(1, 5)
    losses, errors = vectors[:, 0], 0.1 * np.eye(5)
    prior = covariance(vectors, vectors)
    whole = prior + errors
    density = -0.5 * losses @ np.linalg.inv(whole) @ losses - 0.5 * np.linalg.slogdet(whole)[1]
    assert LossField(prior, losses, errors).evidence == pytest.approx(density, abs=1e-4)


def test_predicted_failure_rates_follow_the_counted_failures() -> None:
    vectors = drifts(2, 60)
    shares = np.where(vectors[:, 0] > 0.3, 0.9, 0.02)
    episodes = np.full(60, 50.0)
    prior = covariance(vectors, vectors)
    field = RateField(prior, 36.0, np.round(shares * episodes), episodes, USUAL)
    asked = np.array([[0.8, 0.0], [-0.8, 0.0], [0.0, 0.0]])
    logits, deviations = field.moments(covariance(asked, vectors), variance(asked))
    assert logits[0] > 1.0
    assert logits[1] < -2.0
    assert logits[2] == pytest.approx(USUAL)
    assert (deviations > 0.0).all()


@given(st.integers(0, 10**6), st.sampled_from([9.0, 36.0, 144.0]))
@settings(max_examples=20, deadline=None)
def test_warm_fit_reaches_the_same_maximum(seed: int, scale: float) -> None:
    """At the most probable logits, the weights are the excess of failures over their expectation."""
    vectors = drifts(seed)
    draws = np.random.default_rng(seed + 1)
    episodes = draws.integers(4, 60, 30).astype(float)
    failed = np.round(episodes * draws.uniform(0.0, 1.0, 30) ** 3)
    other = RateField(0.3 * covariance(vectors, vectors), 36.0, failed, episodes, USUAL)
    prior = covariance(vectors, vectors)
    cold = RateField(prior, scale, failed, episodes, USUAL)
    warm = RateField(prior, scale, failed, episodes, USUAL, other.logits)
    for field in (cold, warm):
        logits = field.moments(prior, variance(vectors))[0]
        expected = episodes / (1.0 + np.exp(-logits))
        assert field.weights == pytest.approx(failed - expected, abs=0.6)
    assert warm.evidence == pytest.approx(cold.evidence, abs=0.1)


def test_evidence_grows_with_the_scale_that_matters() -> None:
    vectors = drifts(4, 40)
    losses = vectors[:, 0] ** 2
    errors = 1e-3 * np.eye(40)

    def evidence(units: list[float]) -> float:
        scaled = vectors * units
        return LossField(covariance(scaled, scaled), losses, errors).evidence

    assert evidence([1.0, 0.3]) > evidence([0.3, 1.0])


def test_decorated_function_uses_one_blas_thread() -> None:
    def threads() -> set[int]:
        return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}

    _libraries.cache_clear()  # another test may have loaded scipy's library after the first call
    with threadpool_limits(2, user_api="blas"):
        before = threads()
        assert one_thread(threads)() == {1}
        assert threads() == before
