"""A value that loses missions of its test because the change is too large is moved back towards the original."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.repairing.ledger import Ledger, Tried
from pytest_tarl.repairing.missed import Missed
from pytest_tarl.repairing.other_values import Others
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import operand

PATIENCE = operand(3, "1.0", 1.0)
HARD = 77  # seed of a mission on which a large value fails
GOAL = Goal((Pair(0, 0.0),), near=9.0, enough=9.5, online=0.0, passing=True)
FOUND = Candidate((Mutation(PATIENCE, 5.0),), ALWAYS)


def inward(low: float, high: float, lost: bool = True, known: float = 0.0) -> tuple[list[float], int]:
    """Return the proposals after factor 5 lost a mission if factors from `low` to `high` hold, and the episodes run."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = factor(candidate.mutations[0]) or 1.0
        held = by <= high if seed == HARD else by >= low
        return Outcome(10.0 if held else 0.0, held)

    missed, ledger = Missed(), Ledger()
    if lost:
        missed.few[FOUND] = [(HARD, 9.0)]
    if known:
        candidate = Candidate((Mutation(PATIENCE, known),), ALWAYS)
        ledger.enter(Tried(candidate, "nominal gets worse", ()))
    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=GOAL))
    trials = Trials(run, 50)
    others = Others(mutants, ledger, missed)
    proposed = [factor(one.mutations[0]) or 1.0 for one in others.inward(FOUND, trials)]
    assert list(others.inward(FOUND, trials)) == []  # the same operands are proposed only once
    return proposed, trials.spent


@pytest.mark.parametrize(("low", "high"), [(2.4, 3.4), (2.0, 2.3), (1.3, 4.9)])
def test_a_value_is_moved_back_until_all_missions_succeed(low: float, high: float) -> None:
    (by,), spent = inward(low, high)
    assert low <= by <= high
    assert spent <= 8


def test_without_a_window_or_a_lost_mission_no_value_is_proposed() -> None:
    assert inward(4.0, 3.0)[0] == []
    assert inward(2.4, 3.4, lost=False) == ([], 0)


def test_a_value_that_was_examined_is_not_proposed_again() -> None:
    (by,), _ = inward(2.4, 3.4)
    assert inward(2.4, 3.4, known=by)[0] == []
