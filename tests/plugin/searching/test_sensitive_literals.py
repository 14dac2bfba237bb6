"""Constants without a name whose good values are close to the old one, and tables that are read before any message."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.first_steps import FEW
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit, runs_once
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True)
NARROW = operand(3, "1.05", 1.05)
OTHERS = tuple(operand(4 + n, f"{n}.5", n + 0.5) for n in range(6))


def factor(candidate: Candidate, of: Operand) -> float:
    return next(
        (float(one.value) / float(of.value or 1) for one in candidate.mutations if one.operand == of), 1.0
    )


@pytest.mark.parametrize(("rivals", "early"), [(0, True), (FEW - 1, True), (FEW, False)])
def test_losing_literals_get_small_steps(rivals: int, early: bool) -> None:
    sensitive = OTHERS[:rivals]

    def run(candidate: Candidate, seed: int) -> Outcome:
        off = abs(factor(candidate, NARROW) - 1.07) / 0.07
        lost = 3.0 * sum(factor(candidate, one) != 1.0 for one in sensitive)
        total = (10.0 - off**2 / 10.0 if off < 0.7 else -2.0 * off if off > 1.001 else 0.0) - lost
        return Outcome(total, total > 8.0)

    trials = Trials(run, 300)
    found = next(Sweep((NARROW, *OTHERS), mutations, (ALWAYS,), trials, GOAL).candidates())
    assert [one.operand for one in found.mutations] == [NARROW]
    assert (trials.spent < 45) is early


@pytest.mark.parametrize(("slope", "early"), [(0.3, True), (0.0, False)])
def test_named_constant_gets_a_smaller_step_before_literals(slope: float, early: bool) -> None:
    named = replace(operand(30, "STEPS", 1600.0), definition=operand(1, "1600.0", 1600.0).span)

    def run(candidate: Candidate, _: int) -> Outcome:
        by = next((float(one.value) for one in candidate.mutations if one.operand == named), 1.0)
        if 1.25 < by < 1.4:
            return Outcome(10.0, True)
        near = slope if by < 1.7 else -1.0
        return Outcome(2.5 if 1.15 < by < 1.5 else 0.0 if by == 1.0 else near, False)

    trials = Trials(run, 300)
    found = next(Sweep((*OTHERS, named), mutations, (ALWAYS,), trials, GOAL).candidates())
    assert [one.operand for one in found.mutations] == [named]
    assert (trials.spent <= 14) is early


@pytest.mark.parametrize(("lost", "early"), [(5.0, True), (-1.0, False)])
def test_losing_named_constant_gets_smaller_steps_first(lost: float, early: bool) -> None:
    def constant(line: int, name: str) -> Operand:
        return replace(operand(line, name, 1.0), definition=operand(line - 20, "1.0", 1.0).span)

    culprit, other = constant(30, "AIR"), constant(31, "BAND")

    def run(candidate: Candidate, _: int) -> Outcome:
        by = factor(candidate, culprit)
        if 0.6 < by < 0.7:
            return Outcome(10.0, True)
        if by == 1.0 and factor(candidate, other) == 0.4:
            return Outcome(6.0, True)  # gains much, but never enough
        return Outcome(0.0 if by == 1.0 else -lost, False)

    trials = Trials(run, 300)
    found = next(Sweep((*OTHERS, culprit, other), mutations, (ALWAYS,), trials, GOAL).candidates())
    assert culprit in [one.operand for one in found.mutations]
    assert (trials.spent <= 20) is early


def test_refused_table_change_moves_to_the_use() -> None:
    table = replace(NARROW, site=replace(NARROW.site, qualname=""))
    use = replace(operand(9, "factor", 1.0), value=None, definition=None)
    assert [runs_once(Unit((one,))) for one in (table, use)] == [True, False]

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = factor(candidate, table) * next(
            (float(one.value) for one in candidate.mutations if one.operand == use), 1.0
        )
        good = 2.0 < by < 2.5
        return Outcome(10.0 if good else -5.0 * abs(by - 2.2), good)

    trials = Trials(run, 300)
    found = Sweep((table, use), mutations, (ALWAYS,), trials, GOAL).candidates()
    assert [[one.operand for one in next(found).mutations] for _ in range(2)] == [[table], [use]]
    assert trials.spent < 30
