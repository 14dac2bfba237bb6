"""Confirmation of a candidate: the seeds it runs on, the tolerated misses, and the required reward."""

from __future__ import annotations

import pytest

from pytest_tarl.model import Guard
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.confirming import CONFIRMATIONS, confirmed
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials

CANDIDATE = Candidate((), Guard(()))


def asked(
    totals: list[float], first: int = 0, *, enough: float = 5.0, near: float = 4.0
) -> tuple[bool, list[int]]:
    """Return whether a candidate with these total rewards by seed is confirmed, and the seeds that ran."""
    pairs = tuple(Pair(seed, 0.0) for seed in range(len(totals)))
    ran: list[int] = []

    def run(_candidate: Candidate, seed: int) -> Outcome:
        ran.append(seed)
        return Outcome(totals[seed], True)

    return confirmed(CANDIDATE, Trials(run, 100), Goal(pairs, near, enough, 0.0), first), ran


def test_confirmation_seeds_follow_cyclically() -> None:
    assert asked([9.0] * 9) == (True, [1, 2, 3, 4, 5])
    assert asked([9.0] * 9, 6) == (True, [7, 8, 0, 1, 2])
    assert asked([9.0] * 3, 1) == (True, [2, 0])
    assert len(asked([9.0] * 40)[1]) == CONFIRMATIONS


def test_a_single_seed_needs_no_confirmation() -> None:
    assert asked([9.0]) == (True, [])


@pytest.mark.parametrize(("total", "enough"), [(5.0, True), (4.99, False)])
def test_a_candidate_must_earn_enough_on_average(total: float, enough: bool) -> None:
    assert asked([0.0, *[total] * 5])[0] is enough


def test_confirmation_tolerates_one_miss() -> None:
    assert asked([9.0, 0.0, 9.0, 9.0, 9.0, 9.0]) == (True, [1, 2, 3, 4, 5])
    assert asked([9.0, 0.0, 9.0, 0.0, 9.0, 9.0]) == (False, [1, 2, 3])


def test_total_at_the_limit_is_no_miss() -> None:
    assert asked([9.0, 4.0, 4.0, 9.0, 9.0, 9.0]) == (True, [1, 2, 3, 4, 5])
    assert asked([9.0, 3.99, 3.99, 9.0, 9.0, 9.0]) == (False, [1, 2])


def test_failed_mission_counts_only_if_passing_is_required() -> None:
    goal = Goal((), 4.0, 5.0, 0.0)
    assert goal.reached(Outcome(4.0, False), 0)
    assert not Goal((), 4.0, 5.0, 0.0, passing=True).reached(Outcome(9.0, False), 0)
    assert Goal((), 4.0, 5.0, 0.0, passing=True).reached(Outcome(4.0, True), 0)
