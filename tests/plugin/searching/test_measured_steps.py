"""A sweep tries the changes that recorded missions suggest, once, if the first steps on named constants gain little."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.suggestions import Hint, Suggestions
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant

NAMES = [constant(line, f"C{line}", 2.0) for line in range(3, 9)]
GOAL = Goal(tuple(Pair(seed, 0.0, 50) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True)


def searched(needed: Mapping[Operand, float], hints: Sequence[Hint]) -> tuple[Candidate | None, Trials, int]:
    """Search a world that needs these factors within 1 %; also return how often hints were asked for."""
    asked = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        right = all(abs(by.get(one, 1.0) / factor - 1.0) < 0.01 for one, factor in needed.items())
        return Outcome(10.0 if right else 0.0, right, steps=50)

    def measured(_: object) -> Sequence[Hint]:
        asked.append(True)
        return hints

    trials = Trials(run, 300)
    sweep = Sweep(NAMES, mutations, (ALWAYS,), trials, GOAL, suggestions=Suggestions(measured=measured))
    return next(sweep.candidates(), None), trials, len(asked)


def test_a_suggested_value_is_tried_after_the_first_steps() -> None:
    found, trials, _ = searched({NAMES[2]: 1.28}, [((NAMES[1], 0.7),), ((NAMES[2], 1.28),)])
    assert found is not None
    assert [(one.operand, one.value) for one in found.mutations] == [(NAMES[2], 1.28)]
    assert trials.spent < 40


def test_constants_that_must_change_together_are_suggested_together() -> None:
    needed = {NAMES[2]: 0.45, NAMES[4]: 0.45}
    found, trials, _ = searched(needed, [tuple(needed.items()), ((NAMES[2], 0.45),)])
    assert found is not None
    assert {one.operand for one in found.mutations} == needed.keys()
    assert trials.spent < 40


def test_suggestions_are_requested_once() -> None:
    assert searched({NAMES[5]: 17.0}, [])[2] == 1
    assert searched({NAMES[0]: 2.2}, [])[2] == 0


def test_constants_that_are_not_searched_are_left_out() -> None:
    other = constant(30, "OTHER", 2.0)
    found, _, _ = searched({NAMES[2]: 1.28}, [((other, 1.28),), ((other, 1.28), (NAMES[2], 1.28))])
    assert found is not None
    assert [one.operand for one in found.mutations] == [NAMES[2]]
