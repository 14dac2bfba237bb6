"""Intervals of a difference have their stated coverage, and the effect size agrees with its definition."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pytest_tarl.learning.effect_size import effect_size
from pytest_tarl.learning.student import difference_bounds, student_quantile


@pytest.mark.parametrize(
    ("probability", "degrees", "expected"),
    [
        (0.995, 1, 63.657),
        (0.9995, 2, 31.599),
        (0.9995, 7, 5.4079),
        (0.95, 7, 1.8946),
        (0.975, 10, 2.2281),
        (0.99, 20, 2.5280),
        (0.995, 8, 3.3554),
        (0.95, 1e6, 1.6449),
    ],
)
def test_quantiles_of_students_distribution_agree_with_published_tables(
    probability: float, degrees: float, expected: float
) -> None:
    assert student_quantile(probability, degrees) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("probability", "degrees", "expected"),
    [(0.75, 20, 0.6869545), (0.975, 20, 2.0859634), (0.975, 30, 2.0422725), (0.95, 60, 1.6706489)],
)
def test_the_expansion_for_many_degrees_is_exact_to_five_digits(
    probability: float, degrees: float, expected: float
) -> None:
    assert student_quantile(probability, degrees) == pytest.approx(expected, rel=1e-5)


def test_the_interval_has_the_stated_coverage() -> None:
    covered = 0
    for seed in range(400):
        draws = np.random.default_rng(seed)
        lower, upper = difference_bounds(
            draws.normal(1, 2, 8).tolist(), draws.normal(0, 1, 100).tolist(), 0.05
        )
        covered += lower <= 1 <= upper
    assert 0.86 <= covered / 400 <= 0.95


def test_constant_rewards_give_an_interval_of_length_zero() -> None:
    lower, upper = difference_bounds([3.0] * 8, [3.0] * 20, 0.01)
    assert lower == upper == 0.0
    assert not math.isnan(lower)


def test_the_effect_size_is_hedges_g() -> None:
    first, second = [3.0, 5.0, 7.0], [1.0, 3.0, 5.0]
    assert effect_size(first, second) == pytest.approx((1 - 3 / 15) * 2.0 / 2.0)
    assert effect_size(second, first) == -effect_size(first, second)


def test_constant_rewards_have_no_effect_size() -> None:
    assert math.isnan(effect_size([1.0, 1.0], [2.0, 2.0]))
