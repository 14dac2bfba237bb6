"""Limits that hide each other are relaxed one after another."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.limits_in_turn import EPISODES, Limit, LimitsInTurn
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant

PAIRS = tuple(Pair(seed, 0.0, 10) for seed in range(6))
GOAL = Goal(PAIRS, near=9.0, enough=9.0, online=0.0, passing=True)
TURNS, TIME, HEAT, *REST = (
    constant(n, name) for n, name in enumerate(["TURNS", "TIME", "HEAT", *"ABCDEFG"], start=1)
)
LIMITS = (TURNS, TIME, HEAT)
WHOLE = {one: Unit((one,)) for one in (*LIMITS, *REST)}


class Capper:
    """A mission that each of some limits stops, in order, until it is at least twice as large."""

    def __init__(self, *limits: Operand, needed: float = 2.0) -> None:
        self.limits = limits
        self.needed = needed
        self.asked: list[Candidate] = []

    def stopped_by(self, candidate: Candidate) -> Operand | None:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        return next((one for one in self.limits if by.get(one, 1.0) < self.needed), None)

    def run(self, candidate: Candidate, seed: int) -> Outcome:
        limit = self.stopped_by(candidate)
        if limit is None:
            return Outcome(10.0, True, steps=99)
        size = max((float(one.value) for one in candidate.mutations if one.operand == limit), default=1.0)
        return Outcome(0.0, False, steps=9 + 5 * self.limits.index(limit) + round(size))

    def reached(self, candidate: Candidate) -> Sequence[Limit]:
        self.asked.append(candidate)
        limit = self.stopped_by(candidate)
        return [] if limit is None else [(limit, 2.2)]


def relaxed(world: Capper, bases: Sequence[Joint] = (), budget: int = 100) -> tuple[Candidate | None, Trials]:
    trials = Trials(world.run, budget)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.1)
    return next(LimitsInTurn(selection, WHOLE, world.reached, ALWAYS).candidates(bases), None), trials


def factors(found: Candidate | None) -> dict[Operand, float]:
    return {one.operand: float(one.value) for one in found.mutations} if found is not None else {}


def test_limits_are_relaxed_in_mission_order() -> None:
    found, trials = relaxed(Capper(*LIMITS))
    assert factors(found) == dict.fromkeys(LIMITS, 2.2)
    assert trials.spent < EPISODES


def test_a_limit_that_is_still_reached_is_relaxed_further() -> None:
    found, _ = relaxed(Capper(TURNS, needed=4.0))
    assert factors(found) == {TURNS: 4.84}


def test_a_limit_that_changes_no_mission_ends_its_chain() -> None:
    world = Capper(TURNS, TIME)
    world.reached = lambda candidate: world.asked.append(candidate) or [(TIME, 2.2)]  # type: ignore[method-assign, func-returns-value]
    assert relaxed(world)[0] is None
    assert len(world.asked) == 1


@pytest.mark.parametrize("total", [-5.0, 9.5])
def test_sufficient_or_losing_combination_is_not_extended(total: float) -> None:
    world = Capper(TURNS, TIME)
    world.run = lambda candidate, seed: Outcome(total if seed == PAIRS[0].seed else 0.0, True, steps=20)  # type: ignore[method-assign]
    assert relaxed(world)[0] is None
    assert [one.mutations for one in world.asked] == [()]


def test_combinations_have_limited_factors_and_parts() -> None:
    assert relaxed(Capper(TURNS, needed=30.0))[0] is None
    assert relaxed(Capper(*LIMITS, REST[0]))[0] is None


def test_longer_missions_can_start_a_combination() -> None:
    """The unrepaired mission reaches no limit, because it fails for another reason before."""

    class Torn(Capper):
        def run(self, candidate: Candidate, seed: int) -> Outcome:
            torn = TURNS not in {one.operand for one in candidate.mutations}
            return Outcome(0.0, False, steps=10) if torn else super().run(candidate, seed)

        def reached(self, candidate: Candidate) -> Sequence[Limit]:
            return super().reached(candidate) if candidate.mutations else []

    base = Joint(((WHOLE[TURNS], 2.2),), ALWAYS)
    assert relaxed(Torn(TURNS, TIME))[0] is None
    assert factors(relaxed(Torn(TURNS, TIME), [base])[0]) == {TURNS: 2.2, TIME: 2.2}


def test_limits_that_are_not_searched_are_left_out() -> None:
    other = constant(30, "OTHER")
    assert relaxed(Capper(other))[0] is None


def test_many_limits_cost_a_fixed_number_of_episodes() -> None:
    world, steps = Capper(TURNS), iter(range(20, 999))
    world.run = lambda *_: Outcome(0.0, False, steps=next(steps))  # type: ignore[method-assign]
    world.reached = lambda candidate: [(one, 2.2) for one in LIMITS]  # type: ignore[method-assign]
    found, trials = relaxed(world)
    assert found is None
    assert trials.spent == EPISODES


def test_the_sweep_relaxes_limits_before_it_tries_further_steps() -> None:
    world = Capper(TURNS, TIME)
    trials = Trials(world.run, 300)
    found = next(
        Sweep(
            (*REST, TIME, TURNS),
            mutations,
            (ALWAYS,),
            trials,
            GOAL,
            suggestions=Suggestions(reached=world.reached),
        ).candidates()
    )
    assert factors(found) == {TURNS: 2.2, TIME: 2.2}
    assert trials.spent < 40


def test_sweep_skips_limits_after_a_large_gain() -> None:
    world = Capper(TURNS)
    trials = Trials(world.run, 300)
    found = next(
        Sweep(
            (*REST, TURNS), mutations, (ALWAYS,), trials, GOAL, suggestions=Suggestions(reached=world.reached)
        ).candidates()
    )
    assert factors(found) == {TURNS: 2.2}
    assert world.asked == []
