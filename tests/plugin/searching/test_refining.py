"""The next values of a constant in a search, and the constants that need no further values."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.refining import between, bracket
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_search import operand


@pytest.mark.parametrize(
    ("gains", "expected"),
    [
        ({1.0: 0.0, 2.2: 5.0}, [1.483, 5.06]),  # the outermost factor: inward and outward
        ({1.0: 0.0, 2.2: 5.0, 5.0: 3.0}, [1.483, 3.317]),
        ({1.0: 0.0, 2.2: 0.0, 0.4: 0.0}, []),  # nothing gains
        (
            {1.1: 0.0, 1.16: 5.0, 1.22: 0.0, 1.0: 0.0},
            [1.13, 1.19],
        ),  # a sharp peak is narrower than its neighbours
        ({1.1: 4.0, 1.16: 5.0, 1.22: 3.0, 1.0: 0.0}, []),  # a flat peak needs no further values
        ({1.0: 0.0, 1.1: 2.0, 1.05: 0.0, 1.16: 0.0}, []),  # a small gain may be chance
        ({1.0: 0.0, 1.1: 9.5, 1.05: 9.0, 1.16: 9.0}, [1.075, 1.13]),  # nearly there
        ({1.0: 0.0, 1.05: 2.0, 1.1: -3.0}, [1.025, 1.075]),  # a small gain beside a large loss
        ({1.0: 0.0, 1.14: 5.0, 1.13: 0.0, 1.15: 0.0}, []),  # 2 % are the limit
        ({1.0: 0.0, 2.2: 5.0, 1.5: 5.0, 3.0: 5.0}, []),  # as good on both sides, and still too little
        ({1.0: 0.0, 2.2: 5.0, 1.5: 5.0, 3.1: 5.0}, [1.817, 2.612]),  # the neighbours are far apart
        ({1.0: 0.0, 2.2: 9.0, 1.5: 9.0, 3.0: 9.0}, [1.817, 2.569]),  # nearly there
        ({1.0: 0.0, -1.0: 5.0, 2.2: 1.0}, [-0.435, -2.3]),  # the sign stays
    ],
)
def test_the_next_factors_lie_halfway_to_the_neighbours(
    gains: dict[float, float], expected: list[float]
) -> None:
    assert between(gains, wanted=10.0) == pytest.approx(expected, abs=0.002)


def test_similar_uses_are_tried_once() -> None:
    definition = operand(40, "SPEED", 2.0).span
    passed, used = (Unit((replace(operand(line, "speed", 2.0), definition=definition),)) for line in (3, 4))
    other = Unit((replace(operand(5, "speed", 2.0), definition=operand(41, "SPEED", 2.0).span),))
    gains = Gains(0.1)
    for unit in (passed, used, other):
        gains.enter((unit, ALWAYS), 2.2, 0.01)
    assert gains.distinct([passed, used, other]) == [passed, used, other]  # one equal result may be chance
    for unit in (passed, used, other):
        gains.enter((unit, ALWAYS), 0.4, -0.2)
    assert gains.distinct([passed, used, other]) == [passed, other]
    gains.enter((used, ALWAYS), 1.5, 0.3)
    gains.enter((passed, ALWAYS), 1.5, 0.2)
    assert gains.distinct([passed, used, other]) == [passed, used, other]


@pytest.mark.parametrize(
    ("gains", "expected"),
    [
        ({1.0: 0.0, 2.0: 3.0, 3.0: 1.0}, 3.0),
        ({1.0: 0.0, 2.0: 3.0, 3.0: 2.0}, 1.0),  # the gain hardly falls
        ({1.0: 0.0, 2.0: 3.0}, 1.0),  # a larger factor may be better
        ({0.5: -1.0, 1.0: 0.0, 2.0: -1.0}, 1.0),  # nothing gains
        ({1.0: 0.0, -1.0: 3.0, 2.0: 1.0}, 1.0),  # another sign
    ],
)
def test_a_sharp_peak_lies_between_two_factors(gains: dict[float, float], expected: float) -> None:
    assert bracket(gains) == expected
