"""A value that loses missions of its test because the change is too large is moved back towards the original."""

from __future__ import annotations

from contextlib import suppress
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
from tests.plugin.searching.test_gains import WET
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
    found = list(others.inward(FOUND, trials))
    assert others.chosen == set(found)  # examined as it is: on known missions, the refused value earns more
    proposed = [factor(one.mutations[0]) or 1.0 for one in found]
    assert list(others.inward(FOUND, trials)) == []  # the same operands are proposed only once
    return proposed, trials.spent


@pytest.mark.parametrize(("low", "high"), [(2.4, 3.4), (2.0, 2.3), (1.3, 4.9)])
def test_a_value_is_moved_back_until_all_missions_succeed(low: float, high: float) -> None:
    (by,), spent = inward(low, high)
    assert low <= by <= high
    assert spent <= 8


def test_nothing_is_proposed_without_a_lost_mission() -> None:
    assert inward(4.0, 3.0)[0] == []
    assert inward(2.4, 3.4, lost=False) == ([], 0)


def test_a_value_that_was_examined_is_not_proposed_again() -> None:
    (by,), _ = inward(2.4, 3.4)
    assert inward(2.4, 3.4, known=by)[0] == []


def without_condition(
    drifted: tuple[float, float], guarded: float, designed: float, reason: Any = "gain too small"
) -> tuple[list[float], list[tuple[float, bool]]]:
    """Return the proposals for a change by 5 under a condition, and the (factor, condition) of what ran.

    Without the condition, factors between the two bounds `drifted` reach the goal, under it those from `guarded` on;
    factors above `designed` are refused.
    """
    ran = []

    def run(candidate: Candidate, _: int) -> Outcome:
        by = factor(candidate.mutations[0]) or 1.0
        ran.append((by, bool(candidate.guard.conjuncts)))
        held = by >= guarded if candidate.guard.conjuncts else drifted[0] <= by <= drifted[1]
        return Outcome(10.0 if held else 0.0, held)

    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=GOAL))
    others = Others(mutants, Ledger(), Missed())
    found, proposed = others.unguarded(Candidate(FOUND.mutations, WET), reason, Trials(run, 50)), []
    with suppress(StopIteration):
        candidate = next(found)
        while True:
            assert candidate.guard == ALWAYS
            proposed.append(factor(candidate.mutations[0]) or 1.0)
            reason: Any = "nominal gets worse" if proposed[-1] > designed else "never tested"
            candidate = found.send(Tried(candidate, reason, ()))
    assert list(others.unguarded(Candidate(FOUND.mutations, WET), reason, Trials(run, 50))) == []
    return proposed, ran


def power(*exponents: float) -> Any:
    return pytest.approx([5**one for one in exponents], rel=1e-3)


def test_a_smaller_change_may_need_no_condition() -> None:
    assert without_condition((2.1, 3.0), 2.1, 9.0)[0] == power(0.5)
    proposed, ran = without_condition((1.3, 1.6), 1.3, 9.0)
    assert proposed == power(0.25)  # the first value goes too far without the condition
    assert ran[:2] == [(pytest.approx(5**0.5, rel=1e-3), False), (pytest.approx(5**0.5, rel=1e-3), True)]
    assert without_condition((3.0, 3.6), 3.0, 9.0)[0] == power(0.75)  # the first value is too small


def test_unconditional_value_moves_to_the_middle_of_good_values() -> None:
    assert without_condition((1.4, 3.0), 1.4, 9.0)[0] == power(0.375)
    assert without_condition((2.1, 4.0), 2.1, 9.0)[0] == power(0.625)
    assert without_condition((2.1, 4.0), 2.1, 9.0, "nominal gets worse")[0] == power(0.5)


def test_harmful_change_is_reduced_a_few_times() -> None:
    assert without_condition((1.0, 9.0), 1.0, 1.4, "nominal gets worse")[0] == power(0.375, 0.1875)
    proposed, ran = without_condition((9.0, 8.0), 9.0, 9.0)
    assert proposed == []
    assert len(ran) == 6


def test_unconditional_change_gets_no_smaller_values() -> None:
    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=GOAL))
    trials = Trials(lambda *_: Outcome(10.0, True), 50)
    assert list(Others(mutants, Ledger(), Missed()).unguarded(FOUND, "gain too small", trials)) == []
