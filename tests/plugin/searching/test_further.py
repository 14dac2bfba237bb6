"""How a sweep uses hints: small gains, gains under another condition, hidden parts, and seeds that fail."""

from __future__ import annotations

import math
from collections.abc import Callable

from pytest_tarl.model import Conjunct, Guard
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.confirming import CONFIRMATIONS, confirmed
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.sensors import Sensor
from tests.plugin.searching.test_forward_selection import operand

GAINS = tuple(operand(line, "1.0", 1.0) for line in range(3, 13))
WET = Guard((Conjunct(Sensor("wet", topic="/wet", field="data"), 1, 1),))
PAIRS = tuple(Pair(seed, 0.0) for seed in range(10))
GOAL = Goal(PAIRS, near=9.0, enough=9.5, online=0.0, passing=True)
Earned = Callable[[dict[int, float], Guard], float]  # factors by line


def world(earned: Earned) -> Trials:
    def run(candidate: Candidate, _: int) -> Outcome:
        factors = {m.operand.span.line: float(m.value) for m in candidate.mutations}
        total = earned(factors, candidate.guard)
        return Outcome(total, total > 5.0)

    return Trials(run, 300)


def found(trials: Trials, *guards: Guard) -> Candidate:
    return next(Sweep(GAINS, mutations, guards, trials, GOAL).candidates())


def test_small_gain_gets_larger_factors_before_the_next_condition() -> None:
    def earned(factors: dict[int, float], _: Guard) -> float:
        return (
            10.0 if factors.get(6, 1.0) > 4.0 else 0.2 if factors.get(6, 1.0) > 1.0 else 0.01 * len(factors)
        )

    trials = world(earned)
    assert found(trials, WET, ALWAYS).mutations[0].operand == GAINS[3]
    assert trials.spent <= 2 * len(GAINS) + 1 + CONFIRMATIONS


def test_gains_under_one_condition_are_tried_first_under_the_next() -> None:
    def earned(factors: dict[int, float], guard: Guard) -> float:
        right = factors.get(6, 1.0) > 2.0
        return 10.0 if right and guard == ALWAYS else 0.9 if right else 0.01 * len(factors)

    trials = world(earned)
    candidate = found(trials, WET, ALWAYS)
    assert (candidate.mutations[0].operand, candidate.guard) == (GAINS[3], ALWAYS)
    assert trials.spent <= 2 * len(GAINS) + 8 + CONFIRMATIONS


def test_far_change_is_tried_without_its_condition_first() -> None:
    def earned(factors: dict[int, float], guard: Guard) -> float:
        right = factors.get(6, 1.0) > 4.0
        return (
            10.0
            if right and guard == ALWAYS
            else 3.0
            if right
            else 0.1
            if 6 in factors
            else 0.01 * len(factors)
        )

    trials = world(earned)
    candidate = found(trials, WET, ALWAYS)
    assert (candidate.mutations[0].operand, candidate.guard) == (GAINS[3], ALWAYS)
    assert trials.spent <= 2 * len(GAINS) + 10 + CONFIRMATIONS


def test_ineffective_constant_is_combined_with_two_good_ones() -> None:
    def earned(factors: dict[int, float], _: Guard) -> float:
        first, second = factors.get(3, 1.0) > 2.0, factors.get(4, 1.0) > 2.0
        third = factors.get(12, 1.0) > 4.0
        return 10.0 if first and second and third else 6.0 if first and second else 2.0 * (first + second)

    trials = world(earned)
    parts = {mutation.operand for mutation in found(trials, ALWAYS).mutations}
    assert parts == {GAINS[0], GAINS[1], GAINS[9]}
    assert trials.spent < 80


def test_failed_seeds_come_first_in_a_confirmation() -> None:
    hard = 7

    def run(candidate: Candidate, seed: int) -> Outcome:
        good = seed != hard
        return Outcome(10.0 if good else 0.0, good)

    trials = Trials(run, 300)
    first, second = (Candidate((mutations(GAINS[at], 2.2),), ALWAYS) for at in (0, 1))  # type: ignore[arg-type]
    assert not confirmed(first, trials, GOAL, 3)
    before = trials.spent
    assert not confirmed(second, trials, GOAL, 3)
    assert trials.spent == before + 1


def test_candidate_with_known_losses_is_not_confirmed() -> None:
    trials = world(lambda _, __: 10.0)
    candidate = Candidate((mutations(GAINS[0], 2.2),), ALWAYS)  # type: ignore[arg-type]
    trials.loses = lambda one: one == candidate
    assert not confirmed(candidate, trials, GOAL, 0)
    assert trials.spent == 0


def test_literal_zero_offset_is_refined_half_as_often() -> None:
    zero = operand(3, "0.0", 0.0)

    def run(candidate: Candidate, _: int) -> Outcome:
        value = float(candidate.mutations[0].value)
        total = (
            9.2 - abs(math.log(max(value, 0.01) / 0.7)) / 10
        )  # nearly as good as required, but never sufficient
        return Outcome(total, total > 5.0)

    trials = Trials(run, 300)
    search = Sweep((zero,), mutations, (ALWAYS,), trials, GOAL)
    assert list(search.candidates()) == []
    assert trials.spent < 40


def test_refused_constants_may_be_combined() -> None:
    search = Sweep(GAINS[:2], mutations, (ALWAYS, WET), world(lambda *_: 0.0), GOAL)
    first, second = search.attempts.units
    search.attempts.refused = {(first, ALWAYS), (second, ALWAYS), (first, WET)}
    assert list(search.attempts.combining.leaders(ALWAYS)) == []
    assert search.attempts.refused == {(first, WET)}
