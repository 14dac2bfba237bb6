"""A good value may lie between two rejected ones, close to both."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.repairing.ledger import Ledger, Tried
from pytest_tarl.repairing.missed import Missed
from pytest_tarl.repairing.other_values import Others
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Trials
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_search import operand

PERIOD = Unit((operand(3, "1.0", 1.0),))
GOAL = Goal((), near=9.0, enough=9.0, online=0.0, passing=True)
SHORT, LONG = 7, 11  # seeds on which a shorter and a longer period lose reward


def period(factor: float) -> Candidate:
    return Candidate(PERIOD.mutations(mutations, factor), ALWAYS)


def proposed(best: float, *rejected: tuple[float, int], grid: float = 1e-6) -> tuple[list[float], int]:
    """Return the values proposed beside rejected ones, and the number of episodes that ran.

    The node acts alike with all values between two multiples of `grid`.
    """
    ledger, missed = Ledger(), Missed()
    for factor, seed in rejected:
        ledger.enter(Tried(period(factor), "fails too often", (9.0,), fresh=True, tested=True))
        missed.few[period(factor)] = [(seed, 9.0)]

    def run(candidate: Candidate, seed: int) -> Outcome:
        value = math.ceil(float(candidate.mutations[0].value) / grid) * grid
        failed = value < best / 1.02 if seed == SHORT else value > best * 1.02
        return Outcome(0.1 * value if failed else 10.0, not failed)

    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=GOAL))
    trials = Trials(run, 100)
    found = [float(one.mutations[0].value) for one in Others(mutants, ledger, missed).beside(trials)]
    return found, trials.spent


@pytest.mark.parametrize("best", [1.18, 1.19, 1.20])
def test_value_between_two_rejected_values_is_proposed(best: float) -> None:
    found, _ = proposed(best, (1.144, SHORT), (1.24, LONG))
    assert found[0] == pytest.approx((1.144 * 1.24) ** 0.5, rel=0.002)


def test_value_with_the_same_losses_is_not_proposed() -> None:
    found, _ = proposed(5.0, (1.144, SHORT), (1.24, SHORT))
    assert found == []


@pytest.mark.parametrize(
    ("best", "rejected", "ran", "found"),
    [
        (0.5, (0.79, LONG), 8, [0.324]),  # 0.51 to 1 act alike: 0.79, 0.99, 0.63, 0.88, 0.7 and 0.506
        (0.5, (0.9, LONG), 7, [0.369]),
        (1.5, (0.6, SHORT), 7, [1.465]),
        (0.1, (0.79, LONG), 8, []),  # the next plateau, up to 0.5, fails as well
    ],
)
def test_values_that_act_like_a_rejected_value_are_left_behind(
    best: float, rejected: tuple[float, int], ran: int, found: list[float]
) -> None:
    values, spent = proposed(best, rejected, grid=0.5)
    assert values == pytest.approx(found, abs=0.001)
    assert spent == ran


def test_a_rejected_value_is_never_proposed_again() -> None:
    middle = proposed(1.19, (1.144, SHORT), (1.24, LONG))[0][0]
    found, _ = proposed(1.19, (1.144, SHORT), (1.24, LONG), (middle, LONG))
    assert middle not in found
