"""The factor with which missions follow the designed ones is found from few missions."""

from __future__ import annotations

from math import inf, log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.searching.closest_factor import nearest


@pytest.mark.parametrize("factor", [0.4, 0.82, 1.22, 2.2, 5.0])
@pytest.mark.parametrize("power", [0.3, 0.6, 0.8, 1.0, 1.2, 1.6])
def test_minimum_of_a_linear_deviation_is_found(factor: float, power: float) -> None:
    true, asked = factor**power, list[float]()

    def deviation(one: float) -> float:
        asked.append(one)
        return 0.05 * abs(log(one / true))

    found, least = nearest(factor, deviation)
    assert found == pytest.approx(true, rel=0.02 if abs(power - 1.0) > 0.1 else 0.1)
    assert least == pytest.approx(0.05 * abs(log(found / true)))
    assert len(asked) == len(set(asked)) <= 5


@given(
    st.floats(0.05, 0.9) | st.floats(1.1, 20.0),
    st.lists(st.floats(0.0, 5.0) | st.sampled_from([0.0, inf]), min_size=5, max_size=5),
)
def test_best_of_five_factors_is_returned(factor: float, values: list[float]) -> None:
    asked: dict[float, float] = {}

    def deviation(one: float) -> float:
        asked[one] = values[len(asked)]
        return asked[one]

    found, least = nearest(factor, deviation)
    assert least == min(asked.values()) == asked[found]
    assert all(one > 0.0 for one in asked)
