"""A value that loses too much reward in its test is improved on missions of that test, even by a small change."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.repairing.ledger import Ledger
from pytest_tarl.repairing.missed import SPREAD, Missed
from pytest_tarl.repairing.other_values import Others
from pytest_tarl.searching.accept import Acceptance, Outcome, Reference
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import operand

LITERAL = operand(3, "2.0", 2.0)
REFERENCE = Reference((10.0, 10.0), 1.0, 0.5, 0.0)
GOAL = Goal((Pair(0, 0.0),), near=9.0, enough=9.5, online=0.0, passing=True)


def outcome(by: float, best: float, seed: int) -> Outcome:
    """Return a mission whose loss grows with the distance from the best factor, on some seeds faster than on others."""
    total = 10.0 - (1.0 + seed % 5) * 4.0 * abs(by / best - 1.0)
    return Outcome(total, total > 5.0)


def recentred(best: float, failing: bool = False) -> list[float]:
    """Return the factors proposed after a test of factor 2."""
    candidate = Candidate((Mutation(LITERAL, 4.0),), ALWAYS)
    seen = tuple(Outcome(-5.0, False) if failing else outcome(2.0, best, seed) for seed in range(60))
    found = Acceptance(
        False, "not shown", seen, (), seeds=tuple(range(60)), designed=tuple(10.0 for _ in range(60))
    )
    missed = Missed()
    missed.learn(candidate, found, GOAL, REFERENCE)
    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=GOAL, reference=REFERENCE))
    trials = Trials(lambda one, seed: outcome(factor(one.mutations[0]) or 1.0, best, seed), 300)
    others = Others(mutants, Ledger(), missed)
    proposed = list(others.recentred(candidate, trials))
    assert set(proposed) == others.chosen
    assert trials.spent <= 12 * SPREAD
    return [factor(one.mutations[0]) or 1.0 for one in proposed]


@pytest.mark.parametrize("best", [1.94, 2.06, 2.2, 1.8])
def test_recentring_moves_the_value_towards_the_best_value(best: float) -> None:
    (by,) = recentred(best)
    assert abs(by / best - 1.0) < abs(2.0 / best - 1.0)


def test_a_value_that_loses_nothing_is_not_moved() -> None:
    assert recentred(2.0) == []


def test_failed_missions_do_not_move_the_value() -> None:
    assert recentred(1.94, failing=True) == []


def nearer(window: tuple[float, float], lost: tuple[tuple[int, float], ...] = ()) -> list[float]:
    """Return the factors proposed after a test of factor 2.2 whose missions pass but cost too much as designed.

    `lost` are missions that other refused candidates lost.
    """
    candidate = Candidate((Mutation(LITERAL, 4.4),), ALWAYS)
    seen = tuple(Outcome(10.0, True) for _ in range(60))
    missed = Missed()
    missed.learn(
        candidate,
        Acceptance(
            False, "not shown", seen, seen, seeds=tuple(range(60)), designed=(10.0,) * 60, costly=True
        ),
        GOAL,
        REFERENCE,
    )
    assert (missed.costly, set(missed.spread)) == ({candidate}, set())
    missed.seeds += lost

    def run(one: Candidate, seed: int) -> Outcome:
        low = window[0] if seed == (lost[0][0] if lost else 2) else 1.0  # the other missions tell nothing
        good = low < (factor(one.mutations[0]) or 1.0) < window[1]
        return Outcome(10.0 if good else 0.0, good)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.0, enough=9.5, online=0.0, passing=True)
    mutants: Any = SimpleNamespace(mutate=mutations, order=SimpleNamespace(goal=goal, reference=REFERENCE))
    trials = Trials(run, 300)
    trials.misses[2] = 1
    others = Others(mutants, Ledger(), missed)
    proposed = list(others.improved(candidate, trials))
    assert set(proposed) == others.chosen
    found = [factor(one.mutations[0]) or 1.0 for one in proposed]
    assert list(others.nearer(candidate, trials)) == []  # once
    assert trials.spent <= 12 + 4 * len(lost)
    return found


@pytest.mark.parametrize("low", [1.3, 1.6, 1.9])
def test_costly_value_is_reduced_while_it_succeeds(
    low: float,
) -> None:
    (by,) = nearer((low, 3.0))
    assert low < by < 2.2


@pytest.mark.parametrize(("low", "share"), [(1.3, 0.375), (1.15, 0.25), (1.09, 0.25)])
def test_middle_of_several_smaller_values_is_proposed(low: float, share: float) -> None:
    # the bisection tries 2.2**0.5 and 2.2**0.25 first, and then goes on below or between them
    assert nearer((low, 3.0)) == pytest.approx([2.2**share], rel=1e-3)


def test_a_smaller_value_also_earns_enough_in_missions_that_other_candidates_lost() -> None:
    (by,) = nearer((1.6, 3.0), lost=((99, 9.0),))
    assert 1.6 < by < 2.2


def test_nothing_is_proposed_if_no_smaller_value_succeeds() -> None:
    assert nearer((2.19, 3.0)) == []
