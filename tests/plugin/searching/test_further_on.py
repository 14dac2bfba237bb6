"""A change that leads missions further on is held without a gain, and other constants are tried under it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.further_on import MOST, further_on
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Goal, Pair, Trials
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant

PAIRS = tuple(Pair(seed, 0.0, 100) for seed in range(6))
GOAL = Goal(PAIRS, near=9.0, enough=9.0, online=0.0, passing=True)
REACH, FORCE, *REST = (
    constant(n, name) for n, name in enumerate(["REACH", "FORCE", *"ABCDEFGHIJKLM"], start=1)
)
UNITS = [Unit((one,)) for one in (*REST, FORCE, REACH)]
HELD = Joint(((Unit((REACH,)), 2.2),), ALWAYS)


class Climber:
    """A mission that needs reach at the first step and force at the second; waiting there costs reward."""

    def __init__(self) -> None:
        self.asked: list[Candidate] = []

    def run(self, candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        if by.get(REACH, 1.0) < 1.4:
            return Outcome(0.0, False, steps=100)
        if not 1.3 < by.get(FORCE, 1.0) < 1.9:
            return Outcome(-1.0, False, steps=400 if by.get(FORCE, 1.0) <= 1.3 else 60)
        return Outcome(10.0, True, steps=150)

    def entered(self, candidate: Candidate) -> Sequence[Operand]:
        self.asked.append(candidate)
        return [FORCE] if any(one.operand == REACH for one in candidate.mutations) else []


def found_by(world: Climber, bases: Sequence[Joint], budget: int = 60) -> tuple[Candidate | None, Trials]:
    trials = Trials(world.run, budget)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.9)
    return next(further_on(bases, UNITS, world.entered, selection), None), trials


def changed(found: Candidate | None) -> dict[Operand, float]:
    return {one.operand: float(one.value) for one in found.mutations} if found is not None else {}


def test_constants_of_entered_statements_come_first() -> None:
    found, trials = found_by(Climber(), [HELD])
    assert changed(found) == {REACH: 2.2, FORCE: 1.5}
    assert trials.spent <= 10


def test_change_without_new_statements_is_not_combined() -> None:
    world = Climber()
    longer = Joint(((Unit((REST[0],)), 2.2),), ALWAYS)
    found, trials = found_by(world, [longer])
    assert (found, trials.spent, len(world.asked)) == (None, 0, 1)
    assert changed(found_by(world, [longer, HELD])[0]) == {REACH: 2.2, FORCE: 1.5}


def test_the_number_of_constants_that_are_tried_is_limited() -> None:
    world = Climber()
    world.entered = lambda candidate: [REACH]  # type: ignore[method-assign]
    _, trials = found_by(world, [HELD])
    assert trials.spent == 1 + 2 * MOST  # the base, and each constant increased and decreased


@pytest.mark.parametrize("helps", [True, False])
def test_sweep_combines_a_change_that_leads_missions_further(helps: bool) -> None:
    world = Climber()
    trials = Trials(world.run, 60)
    asked = world.entered if helps else lambda _: ()
    sweep = Sweep(
        (*REST[:6], FORCE, REACH), mutations, (ALWAYS,), trials, GOAL, suggestions=Suggestions(entered=asked)
    )
    found = None
    with suppress(BudgetSpentError):
        found = next(sweep.candidates(), None)
    assert (set(changed(found)) == {REACH, FORCE}) is helps
