"""A definition counts as used if changing it alters missions, alone or with the other changes of a repair."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pytest_tarl.patching.constant_definitions import Place
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.placing import Placing
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Pair
from tests.plugin.searching.test_gains import constant

REACH, FORCE = constant(1, "REACH"), constant(2, "FORCE")
USES = (
    Mutation(REACH, 1.5),
    Mutation(FORCE, 1.5),
    Mutation(replace(FORCE, span=replace(FORCE.span, line=9)), 1.5),
)
PLACE = Place("a.py", 0, 3, 1, "FORCE", 2.0)


@pytest.mark.parametrize(
    ("used", "hidden", "expected", "most"),
    [
        (True, False, True, 1),  # alters missions alone
        (True, True, True, 3),  # only beside the change of REACH
        (False, False, False, 3),
        (False, True, False, 3),
    ],
)
def test_definition_change_is_tried_with_other_changes(
    used: bool, hidden: bool, expected: bool, most: int
) -> None:
    ran: list[Candidate] = []

    def trials(candidate: Candidate, _: int) -> Outcome:
        ran.append(candidate)
        reaches = not hidden or any(one.operand == REACH for one in candidate.mutations)
        forced = used and any(one.place == PLACE for one in candidate.mutations)
        return Outcome(float(reaches and forced), True)

    order: Any = SimpleNamespace(goal=SimpleNamespace(pairs=(Pair(1, 0.0),)))
    mutants: Any = SimpleNamespace(order=order)
    run: Any = trials
    assert Placing(mutants)._moves(USES[1], [PLACE], Candidate(USES, ALWAYS), run) is expected
    assert len(ran) == most
    assert all(one.operand == REACH for one in ran[-1].mutations) is (most == 3)
