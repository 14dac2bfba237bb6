"""Extreme changes, and the small steps of other constants that come before them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.moderate import STEPS, extreme, moderate
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import A, B, C, constant
from tests.plugin.searching.test_search import operand


@pytest.mark.parametrize(
    ("unit", "factor", "expected"),
    [
        (A, 11.5, True),
        (A, 0.1, True),
        (A, 7.9, False),
        (A, -11.5, False),
        (Unit((constant(3, "ZERO", 0.0),)), 11.5, False),
        (Unit((constant(3, "UNKNOWN", None),)), 11.5, False),
        (Unit((replace(operand(3, "True", 1.0), value=True),)), 0.0, False),
    ],
)
def test_eightfold_change_is_extreme(unit: Unit, factor: float, expected: bool) -> None:
    assert extreme(unit, factor) is expected


def test_small_steps_begin_with_the_constant_that_loses_most() -> None:
    gains = Gains(0.5)
    for unit, factor, gain in ((A, 11.5, 9.0), (B, 1.22, -0.6), (C, 1.22, -3.0), (C, 1.1, -2.0)):
        gains.enter((unit, ALWAYS), factor, gain)
    literal = Unit((operand(9, "0.5", 0.5),))
    still = Unit((constant(8, "STILL"),))
    gains.enter((still, ALWAYS), 2.2, 0.0)
    found = moderate(A, [A, B, C, literal, still], gains, ALWAYS)
    assert found == [*((C, one) for one in STEPS if one != 1.1), *((B, one) for one in STEPS)]
