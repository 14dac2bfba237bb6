"""The numbers that a drift, a schedule and a fault accept in a marker."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from pytest_tarl import Drift, faults
from pytest_tarl.errors import SettingsError
from pytest_tarl.finite_numbers import finite_number

NUMBERS: list[Any] = [1, 0.5, Fraction(1, 4), np.float32(0.5), np.int64(3), np.array(2.0)]
OTHERS: list[Any] = [
    True, np.bool_(True), np.array(True), None, "1", b"1", float("nan"), float("inf"), np.float64("inf"), 10**400,
    Decimal("1"), 1j, [1.0], np.array([1.0]),
]  # fmt: skip


@pytest.mark.parametrize("value", NUMBERS, ids=repr)
def test_finite_numbers_of_any_type_are_accepted(value: Any) -> None:
    found = finite_number(value)
    assert type(found) is float
    assert found == float(value)
    Drift.range(-1.0, 5.0, nominal=value)
    Drift.step(0.0, 1.0, nominal=0.0, at=value)
    assert faults.freeze("/scan", value, at=value).extent.high == found
    assert faults.restart("pilot", value, at=value).at == found


@pytest.mark.parametrize("value", OTHERS, ids=repr)
def test_non_finite_values_are_reported_in_one_sentence(value: Any) -> None:
    assert finite_number(value) is None
    for give in (
        lambda: Drift.range(value, 5.0),
        lambda: Drift.step(0.0, 1.0, nominal=0.0, at=value),
        lambda: faults.freeze("/scan", value),
        lambda: faults.freeze("/scan", 1.0, at=value),
        lambda: faults.restart("pilot", 1.0, at=value),
    ):
        with pytest.raises(SettingsError, match=r"number|moment"):
            give()
