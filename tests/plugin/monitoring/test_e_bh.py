"""The region of a watch: the e-BH procedure on adjusted running maxima."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.monitoring.e_bh import adjusted, chosen


@given(st.lists(st.floats(-5, 20), max_size=12), st.sampled_from([0.05, 0.2, 0.5]))
def test_e_bh_rejects_the_largest_valid_number_of_hypotheses(logs: list[float], alpha: float) -> None:
    values = 2.0 ** np.array(logs)
    largest = 0
    for k in range(1, len(logs) + 1):
        if np.sort(values)[::-1][k - 1] * k * alpha >= len(logs) * (1 - 1e-12):
            largest = k
    picked = chosen(np.array(logs), alpha)
    assert picked.sum() == largest
    if 0 < largest < len(logs):
        assert values[picked].min() >= values[~picked].max()


def test_the_adjuster_integrates_to_at_most_one() -> None:
    """∫ F(x)/x² dx over [1, ∞) with x = e^u is ∫ F(e^u) e^(-u) du."""
    u = np.linspace(0.0, 400.0, 400_001)
    value = np.exp2(adjusted(u / np.log(2.0))) * np.exp(-u)
    integral = float(((value[1:] + value[:-1]) / 2).sum() * (u[1] - u[0]))
    assert 0.99 < integral <= 1.0 + 1e-6  # the remaining integral beyond 400 is 1/400


@given(st.floats(0, 2000), st.floats(0, 2000))
def test_the_adjuster_is_an_increasing_function(a: float, b: float) -> None:
    low, high = adjusted(np.array(sorted((a, b))))
    assert low <= high + 1e-9


def test_cells_without_evidence_are_never_selected() -> None:
    assert not chosen(adjusted(np.zeros(40)), 0.05).any()
    assert chosen(np.empty(0), 0.05).tolist() == []
    assert adjusted(np.array([0.0]))[0] == pytest.approx(-1.0)
