"""If only success is rewarded, all failed missions earn the same; their course shows which constants matter."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant
from tests.plugin.searching.test_search import operand

LOST, STEPS = -4.0, 100
RIGHT = operand(3, "38.0", 38.0)
INERT = [operand(line, f"{line}.5", line + 0.5) for line in range(4, 14)]


def searched(low: float, high: float, steps: int | None) -> tuple[Candidate | None, int]:
    """Search a world in which one factor of one constant succeeds; return the result and the number of episodes."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        moved = {one.operand: factor(one) or 1.0 for one in candidate.mutations}
        by = moved.get(RIGHT, 1.0)
        won = low <= by <= high
        return Outcome(10.0 if won else LOST, won, steps=STEPS + round(10 * (by - 1.0)))

    pairs = tuple(Pair(seed, LOST, steps) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=LOST, passing=True)
    trials = Trials(run, 300)
    sweep = Sweep([*INERT, RIGHT], mutations, (ALWAYS,), trials, goal)
    found = next(sweep.candidates(), None)
    return found, trials.spent


def test_constants_of_failed_missions_get_small_steps_first() -> None:
    found, spent = searched(1.4, 1.8, STEPS)
    blind, more = searched(1.4, 1.8, None)
    assert found is not None
    assert {one.operand for one in found.mutations} == {RIGHT}
    assert blind is not None
    assert spent <= 2 * (len(INERT) + 1) + 8 < more


def test_steps_become_smaller_as_long_as_nothing_gains() -> None:
    found, spent = searched(1.15, 1.3, STEPS)
    assert found is not None
    assert {one.operand for one in found.mutations} == {RIGHT}
    assert spent <= 2 * (len(INERT) + 1) + 12


def test_weak_proposal_is_strengthened_first() -> None:
    """With a limit of 1 nothing changes and with a limit of 0.4 missions succeed; other values lose reward."""
    tried: list[tuple[object, float]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (one,) = candidate.mutations
        tried.append((one.operand, float(one.value)))
        won = one.operand == RIGHT and one.value < 0.6
        idle = one.operand == RIGHT and not won
        return Outcome(10.0 if won else LOST if idle else LOST - 1.0, won, steps=STEPS + (not idle))

    pairs = tuple(Pair(seed, LOST, STEPS) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=LOST, passing=True)
    proposals = [*INERT[:4], RIGHT]

    def mutate(one: Operand, by: float) -> Mutation:
        return Mutation(one, by)

    sweep = Sweep(
        proposals, mutate, (ALWAYS,), Trials(run, 300), goal, proposed=True, weaker=lambda _, by: by > 1.0
    )
    found = next(sweep.candidates())
    assert [(one.operand, one.value) for one in found.mutations] == [(RIGHT, 0.4)]
    assert tried[: len(proposals) + 1] == [*((one, 1.0) for one in proposals), (RIGHT, 0.4)]


def test_constants_get_ever_larger_steps_until_one_constant_gains() -> None:
    found, _ = searched(8.0, 12.0, STEPS)
    assert found is not None
    assert {one.operand for one in found.mutations} == {RIGHT}


def test_weak_proposal_is_strengthened_where_constants_gained() -> None:
    """Only a limit of 0.15 has an effect; elsewhere proposals without an effect are dropped after 0.4."""
    tried: list[tuple[Operand, float]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (one,) = candidate.mutations
        tried.append((one.operand, float(one.value)))
        won = one.operand == RIGHT and one.value < 0.3
        return Outcome(10.0 if won else LOST, won, steps=STEPS)

    pairs = tuple(Pair(seed, LOST, STEPS) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=LOST, passing=True)
    sweep = Sweep(
        [*INERT[:4], RIGHT],
        Mutation,
        (ALWAYS,),
        Trials(run, 300),
        goal,
        proposed=True,
        weaker=lambda _, by: by > 1.0,
        responding=[str(RIGHT.site)],
    )
    found = next(sweep.candidates())
    assert [(one.operand, one.value) for one in found.mutations] == [(RIGHT, 0.15)]
    assert {value for one, value in tried if one != RIGHT} == {1.0, 0.4}


@pytest.mark.parametrize(
    "center", [0.57, 0.63, 0.72, 0.76, 0.88, 0.93, 1.08, 1.13, 1.19, 1.25, 1.32, 1.46, 1.69]
)
def test_narrow_good_range_is_found_on_a_plateau(center: float) -> None:
    right = constant(3, "RIGHT", 38.0)
    others = [constant(line, f"C{line}", 2.0) for line in range(4, 10)]

    def run(candidate: Candidate, seed: int) -> Outcome:
        moved = {one.operand: factor(one) or 1.0 for one in candidate.mutations}
        won = center / 1.06 <= moved.get(right, 1.0) <= center * 1.06
        return Outcome(10.0 if won else LOST, won, steps=STEPS + (right in moved))

    pairs = tuple(Pair(seed, LOST, STEPS) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=LOST, passing=True)
    found = next(Sweep([*others, right], mutations, (ALWAYS,), Trials(run, 60), goal).candidates())
    assert {one.operand for one in found.mutations} == {right}
