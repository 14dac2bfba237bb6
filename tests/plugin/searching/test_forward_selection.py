"""Uses of one constant move together, and culprits that only help together are found together."""

from __future__ import annotations

import math
from statistics import fmean

import numpy as np

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import units
from tarl_lint.model import Operand, SiteId, Span

ELSEWHERE = Span("node.py", 1, 1, 1, 4)


def operand(line: int, code: str, value: float | None, column: int = 5, named: bool = False) -> Operand:
    span = Span("node.py", line, column, line, column + len(code))
    return Operand(SiteId("node", "run", f"line {line}"), span, code, value, ELSEWHERE if named else span)


def test_uses_in_a_statement_change_together() -> None:
    first, second = operand(3, "LIMIT", 2.0, 5, named=True), operand(3, "LIMIT", 2.0, 20, named=True)
    elsewhere = operand(4, "LIMIT", 2.0, 5, named=True)
    assert [unit.operands for unit in units([first, elsewhere, second])] == [(first, second), (elsewhere,)]


def test_symmetric_limits_change_together() -> None:
    low, high = operand(3, "-2.0", -2.0, 5), operand(3, "2.0", 2.0, 20)
    half, other = operand(4, "0.5", 0.5, 5), operand(4, "0.5", 0.5, 20)
    assert [len(unit.operands) for unit in units([low, high, half, other])] == [2, 1, 1]


GAINS = tuple(operand(line, "1.0", 1.0) for line in range(3, 11))
NEEDED = {GAINS[2]: 2.5, GAINS[5]: 0.4, GAINS[6]: 2.0}


def run(candidate: Candidate, seed: int) -> Outcome:
    """A world with three wrong gains, each of which costs reward; changing any other gain costs, too."""
    noise = float(np.random.default_rng(seed).normal(0, 0.1))
    factors = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
    wrong = [abs(math.log(max(factors.get(gain, 1.0), 0.01) / NEEDED.get(gain, 1.0))) for gain in GAINS]
    total = 10.0 - sum(min(4.0 * max(one - 0.35, 0.0), 3.0) for one in wrong) + noise
    return Outcome(total, total > 9)


PAIRS = tuple(Pair(seed, run(Candidate((), ALWAYS), seed).total) for seed in range(10))
GOAL = Goal(PAIRS, near=9.3, enough=9.5, online=fmean(pair.total for pair in PAIRS))


def test_three_culprits_are_found_and_nothing_else() -> None:
    trials = Trials(run, 300)
    search = Sweep(GAINS, mutations, (ALWAYS,), trials, GOAL)
    found = next(search.candidates())
    assert {mutation.operand for mutation in found.mutations} == set(NEEDED)
    assert trials.spent < 150


def test_a_flipped_sign_is_restored() -> None:
    def turned(candidate: Candidate, seed: int) -> Outcome:
        (mutation,) = candidate.mutations
        good = mutation.operand == GAINS[4] and mutation.value == -1.0
        return Outcome(10.0 if good else 0.0, good)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.5, online=0.0)
    found = next(Sweep(GAINS, mutations, (ALWAYS,), Trials(turned, 300), goal).candidates())
    assert [(m.operand, m.value) for m in found.mutations] == [(GAINS[4], -1.0)]


def test_signs_change_before_larger_steps() -> None:
    def turned(candidate: Candidate, seed: int) -> Outcome:
        factors = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
        total = 5.0 - 5.0 * factors.get(GAINS[4], 1.0)
        return Outcome(total, total > 9.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.5, online=0.0)
    trials = Trials(turned, 300)
    found = next(Sweep(GAINS, mutations, (ALWAYS,), trials, goal).candidates())
    assert [(m.operand, m.value) for m in found.mutations] == [(GAINS[4], -1.0)]
    assert trials.spent <= 3 * len(GAINS)


def test_second_culprit_is_combined_first() -> None:
    def world(candidate: Candidate, seed: int) -> Outcome:
        factors = {mutation.operand: float(mutation.value) for mutation in candidate.mutations}
        steered = factors.get(GAINS[3], 1.0) > 2.0
        pulled = factors.get(GAINS[6], 1.0) > 2.0
        total = 10.0 if steered and pulled else 4.0 * steered + 0.1 * pulled
        return Outcome(total, total > 9.0)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(6)), near=9.0, enough=9.5, online=0.0)
    trials = Trials(world, 300)
    found = next(Sweep(GAINS, mutations, (ALWAYS,), trials, goal).candidates())
    assert {mutation.operand for mutation in found.mutations} == {GAINS[3], GAINS[6]}
    assert trials.spent < 40
