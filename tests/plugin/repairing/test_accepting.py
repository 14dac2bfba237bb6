"""What is told of candidates that were refused."""

from __future__ import annotations

from pytest_tarl.model import Guard
from pytest_tarl.repairing.accepting import Refused, furthest
from pytest_tarl.searching.search import Candidate

SOME, ANOTHER = Candidate((), Guard()), Candidate((), Guard(()))
NONE = Refused(None, "no operand helps")


def test_any_candidate_says_more_than_none() -> None:
    refused = Refused(SOME, "gain too small")
    assert furthest(NONE, refused) is refused
    assert furthest(refused, NONE) is refused


def test_what_held_in_the_drifted_world_came_further_than_what_did_not() -> None:
    weak, costly = Refused(SOME, "gain too small", 9.0), Refused(ANOTHER, "nominal gets worse")
    assert furthest(weak, costly) is costly
    assert furthest(costly, weak) is costly


def test_among_equals_the_one_that_earned_most_is_told_and_the_first_where_none_did() -> None:
    low, high = Refused(SOME, "gain too small", 3.0), Refused(ANOTHER, "gain too small", 4.0)
    assert furthest(low, high) is high
    first, second = Refused(SOME, "gain too small"), Refused(ANOTHER, "gain too small")
    assert furthest(first, second) is first


def test_what_only_another_test_refused_came_furthest() -> None:
    costly, elsewhere = (
        Refused(SOME, "nominal gets worse", 9.0),
        Refused(ANOTHER, "another test gets worse", 8.0),
    )
    assert furthest(costly, elsewhere) is elsewhere
    assert furthest(elsewhere, costly) is elsewhere
