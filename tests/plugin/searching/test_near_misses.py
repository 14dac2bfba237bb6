"""A change that passes its missions and earns nearly enough gets a better value before other changes are tried."""

from __future__ import annotations

from math import log

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import units
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

GOAL = Goal(
    tuple(Pair(seed, -5.0) for seed in range(8)), near=8.0, enough=9.6, online=-5.0, passing=True, margin=0.3
)
(UNIT,) = units([operand(3, "2.0", 2.0)])


def tries(best: float, width: float, finer: list[Operand], proposed: bool = True) -> Attempts:
    """Return attempts in a world in which the factor `best` earns 10, and all factors near it pass their missions."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        found = float(candidate.mutations[0].value) / 2.0
        total = 10.0 - (log(found / best) / width) ** 2
        return Outcome(max(total, -5.0), total > 7.0)

    trials = Trials(run, 200, design=lambda seed: Outcome(10.0, True))
    return Attempts((UNIT,), mutations, (ALWAYS,), trials, GOAL, proposed=proposed, finer=finer.append)


def test_nearly_sufficient_value_is_adjusted_at_once() -> None:
    finer: list[Operand] = []
    search = tries(2.5, 0.15, finer)  # 2.2 earns 9.27
    (found,) = search.attempt(UNIT, ALWAYS, 2.2, 0)
    assert float(found.mutations[0].value) / 2.0 == pytest.approx(2.5, rel=0.08)
    assert finer == [UNIT.operands[0]]
    assert search.trials.spent < 40


@pytest.mark.parametrize(
    ("best", "width"),
    [
        (3.0, 0.2),  # 2.2 earns 7.6, and does not reach the goal on its first seed
        (2.2, 0.2),  # 2.2 is confirmed
    ],
)
def test_other_values_are_not_adjusted(best: float, width: float) -> None:
    finer: list[Operand] = []
    list(tries(best, width, finer).attempt(UNIT, ALWAYS, 2.2, 0))
    assert finer == []


def test_each_constant_is_adjusted_only_once() -> None:
    finer: list[Operand] = []
    search = tries(2.5, 0.15, finer)
    list(search.attempt(UNIT, ALWAYS, 2.2, 0))
    spent = search.trials.spent
    assert list(search.attempt(UNIT, ALWAYS, 2.21, 0)) == []
    assert search.trials.spent - spent <= 12  # six missions, and the designed ones of their seeds
    assert len(finer) == 1


@pytest.mark.parametrize(
    ("known", "adjusted"),
    [
        ({}, False),
        ({1.9: 0.0, 2.6: 0.0}, True),
        ({1.9: 0.0, 5.0: 0.0}, False),  # larger steps reach the values up to 5
        ({1.9: 0.0, 2.6: 13.0}, False),  # 2.6 is about as good
        ({2.1: 13.0, 2.3: 13.0}, True),  # no other step lies between these
    ],
)
def test_constant_is_adjusted_between_close_values(known: dict[float, float], adjusted: bool) -> None:
    finer: list[Operand] = []
    search = tries(2.5, 0.15, finer, proposed=False)
    for factor, gain in known.items():
        search.gains.enter((UNIT, ALWAYS), factor, gain)
    list(search.attempt(UNIT, ALWAYS, 2.2, 0))
    assert bool(finer) is adjusted
