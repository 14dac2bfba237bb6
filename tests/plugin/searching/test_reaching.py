"""A mission that lacks little of the goal is compared with the designed mission of its seed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Goal, Pair, Trials

CANDIDATE = Candidate((), Guard(()))
GOAL = Goal(
    tuple(Pair(seed, 3.0) for seed in range(4)), near=8.0, enough=9.0, online=-2.0, passing=True, margin=0.4
)


def trials(total: float, designed: float | None, passed: bool = True) -> Trials:
    design = None if designed is None else lambda seed: Outcome(designed, True)
    return Trials(lambda candidate, seed: Outcome(total, passed), 10, design=design)


@pytest.mark.parametrize(
    ("total", "designed", "expected", "beside"),
    [
        (8.0, 9.5, True, 0),  # reaches the goal
        (7.9, 8.2, True, 1),  # the start of this mission is bad, and no program earns more
        (7.9, 8.4, False, 1),  # loses more than the margin
        (7.0, 7.2, True, 1),  # lacks a tenth of what separates the worlds
        (6.9, 6.9, False, 0),  # lacks more
    ],
)
def test_near_miss_is_compared_with_its_designed_mission(
    total: float, designed: float, expected: bool, beside: int
) -> None:
    ran = trials(total, designed)
    assert ran.reaches(CANDIDATE, 1, GOAL) is expected
    assert ran.beside == beside
    assert ran.reaches(CANDIDATE, 1, GOAL) is expected
    assert ran.beside == beside


@pytest.mark.parametrize("goal", [replace(GOAL, margin=None), replace(GOAL, harder={1: 0.0})])
def test_only_the_goal_decides_without_a_margin(goal: Goal) -> None:
    ran = trials(7.9, 7.9)
    assert not ran.reaches(CANDIDATE, 1, goal)
    assert ran.beside == 0


def test_failed_mission_is_not_compared() -> None:
    failed, bare = trials(7.9, 7.9, passed=False), trials(7.9, None)
    assert not failed.reaches(CANDIDATE, 1, GOAL)
    assert not bare.reaches(CANDIDATE, 1, GOAL)
    assert failed.beside == bare.beside == 0


def test_examination_returns_unused_episodes() -> None:
    ran = trials(9.0, None)
    ran.budget, ran.limit = 2, 5
    ran(CANDIDATE, 0)
    ran(CANDIDATE, 1)
    with ran.granting(2):
        assert ran.budget == 4
        ran(CANDIDATE, 2)
    assert ran.budget == 2
    with ran.granting(9):
        assert ran.budget == 5
    with pytest.raises(BudgetSpentError):
        ran(CANDIDATE, 3)


def test_an_examination_with_episodes_left_changes_no_budget() -> None:
    ran = trials(9.0, None)
    with ran.granting(3):
        assert ran.budget == 10
    ran.limit = 30
    with ran.granting(3):
        assert ran.budget == 10
    assert ran.budget == 10
