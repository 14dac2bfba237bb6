"""A confirmed change follows the changes preferred to it, even if looking for them spends the last episodes."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.preferred_first import then
from pytest_tarl.searching.search import BudgetSpentError, Candidate
from tests.plugin.searching.test_search import operand

FOUND, NICER = (Candidate((Mutation(operand(3, "2.0", 2.0), value),), ALWAYS) for value in (4.0, 3.0))


def test_preferred_changes_come_first() -> None:
    assert list(then(FOUND, iter((NICER,)))) == [NICER, FOUND]
    assert list(then(FOUND, iter(()))) == [FOUND]


@pytest.mark.parametrize("before", [[], [NICER]])
def test_change_follows_when_the_budget_ends(before: list[Candidate]) -> None:
    def preferred() -> Iterator[Candidate]:
        yield from before
        raise BudgetSpentError

    changes = then(FOUND, preferred())
    assert [next(changes) for _ in range(len(before) + 1)] == [*before, FOUND]
    with pytest.raises(BudgetSpentError):
        next(changes)
