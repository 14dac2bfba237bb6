"""A candidate that earns less than the mean designed mission is compared with the designed missions of its seeds."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.confirming import confirmed
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials

CANDIDATE = Candidate((), Guard(()))
PAIRS = tuple(Pair(seed, -5.0) for seed in range(8))
GOAL = Goal(PAIRS, near=8.0, enough=9.0, online=-5.0, passing=True, margin=0.4)


def trials(lost: float, designed: float = 8.5, passed: bool = True) -> Trials:
    """Return trials on seeds that all earn `designed` as designed, and `lost` less with the candidate."""
    return Trials(
        lambda candidate, seed: Outcome(designed - lost, passed),
        100,
        design=lambda seed: Outcome(designed, True),
    )


@pytest.mark.parametrize(("lost", "expected"), [(0.0, True), (0.35, True), (0.45, False)])
def test_hard_seed_does_not_reject_a_candidate(lost: float, expected: bool) -> None:
    assert confirmed(CANDIDATE, trials(lost), GOAL, 0) is expected


def test_designed_missions_run_only_if_the_mean_is_small() -> None:
    ran = trials(0.0)
    assert confirmed(CANDIDATE, ran, GOAL, 0)
    once = ran.spent
    assert ran.beside == 5
    assert confirmed(CANDIDATE, ran, GOAL, 0)
    assert ran.spent == once
    enough = trials(0.0, designed=9.5)
    assert confirmed(CANDIDATE, enough, GOAL, 0)
    assert enough.beside == 0


@pytest.mark.parametrize("goal", [replace(GOAL, margin=None), replace(GOAL, harder={1: 0.1})])
def test_known_designed_rewards_run_no_mission(goal: Goal) -> None:
    ran = trials(0.0)
    assert not confirmed(CANDIDATE, ran, goal, 0)
    assert ran.beside == 0


def test_clearly_failed_missions_are_not_compared() -> None:
    failing, short = trials(0.0, passed=False), trials(0.0, designed=6.5)
    assert not confirmed(CANDIDATE, failing, GOAL, 0)
    assert not confirmed(CANDIDATE, short, GOAL, 0)
    assert failing.beside == short.beside == 0


def test_clearly_worse_candidate_is_compared_first() -> None:
    goal = replace(GOAL, enough=9.4)  # 8.5 is nearer to `near` than to this
    worse, as_designed = trials(0.45), trials(0.0)
    assert not confirmed(CANDIDATE, worse, goal, 0)
    assert len(worse.totals) == 3
    assert confirmed(CANDIDATE, as_designed, goal, 0)
    assert len(as_designed.totals) == 5


def test_without_a_designed_world_the_mean_decides() -> None:
    ran = Trials(lambda candidate, seed: Outcome(8.5, True), 100)
    assert not confirmed(CANDIDATE, ran, GOAL, 0)
    assert ran.lost(CANDIDATE, [1, 2]) is None
