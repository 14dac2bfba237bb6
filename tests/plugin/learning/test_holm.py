"""Holm's correction."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytest_tarl.learning.multiple_testing import holm

P_VALUES = st.lists(st.floats(0.0, 1.0), max_size=8)


def test_holms_correction_equals_a_worked_example() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx((0.03, 0.06, 0.06, 0.02))


@given(P_VALUES)
def test_corrected_p_values_keep_their_order(
    p_values: list[float],
) -> None:
    corrected = holm(p_values)
    count = len(p_values)
    assert all(p <= q <= min(1.0, count * p) + 1e-12 for p, q in zip(p_values, corrected, strict=True))
    pairs = sorted(zip(p_values, corrected, strict=True))
    assert [q for _, q in pairs] == sorted(q for _, q in pairs)
