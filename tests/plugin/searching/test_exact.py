"""Values with which missions equal the designed ones are found before combinations and alternative constants win."""

from __future__ import annotations

from math import log

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.exact import exactest
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_closeness import LATE, LEAK, POWER, STEADY
from tests.plugin.searching.test_gains import constant

PAIRS = tuple(Pair(seed, 0.0, 10) for seed in range(8))
GOAL = Goal(PAIRS, near=9.0, enough=9.5, online=0.0, passing=True)
OTHERS = [constant(line, f"C{line}", 2.0) for line in range(10, 16)]


def design(_: int) -> Outcome:
    return Outcome(10.0, True, rewards=STEADY)


def mixed(late: float) -> tuple[float, ...]:
    """Return the rewards of a mission in which a share of the reward comes late; its deviation is a quarter of it."""
    return tuple((1.0 - late) * one + late * other for one, other in zip(STEADY, LATE, strict=True))


def changed(candidate: Candidate, operand: Operand) -> float:
    return {one.operand: factor(one) or 1.0 for one in candidate.mutations}.get(operand, 1.0)


def test_exact_value_is_found_before_combining() -> None:
    """The reward falls linearly around 0.74, and 0.4 % off it no longer suffices."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        off = abs(log(changed(candidate, POWER) / 0.74))
        total = max(10.0 - 40.0 * off, 0.0)
        return Outcome(total, off < 0.25, steps=10, rewards=(total / 10,) * 10)

    trials = Trials(run, 300, design=design)
    found = next(Sweep([POWER, *OTHERS], mutations, (ALWAYS,), trials, GOAL).candidates())
    assert changed(found, POWER) == pytest.approx(0.74, rel=0.015)
    assert not any("," in label for label in trials.labels)


def test_alternative_is_compared_at_its_exact_value() -> None:
    """LEAK hides that POWER is 0.72 of what it was; the factor tried first on alternatives, 0.667, is not exact."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        off = abs(log(changed(candidate, POWER) / 0.72))
        if 1.4 < changed(candidate, LEAK) < 1.6:
            return Outcome(10.0, True, rewards=mixed(0.1))
        if off < 0.15:
            return Outcome(10.0, True, rewards=mixed(off))
        return Outcome(0.1 * (2.0 - off), False, rewards=(0.0,) * 10)

    trials = Trials(run, 300, design=design)
    found = next(Sweep((LEAK, POWER), mutations, (ALWAYS,), trials, GOAL).candidates())
    assert [one.operand for one in found.mutations] == [POWER]
    assert changed(found, POWER) == pytest.approx(0.72, rel=0.01)


def test_booleans_and_sign_changes_keep_their_factor() -> None:
    flag, seen = Unit((constant(3, "FLAG", True),)), list[Candidate]()

    def run(candidate: Candidate, seed: int) -> Outcome:
        seen.append(candidate)
        if changed(candidate, POWER) > 2.0:
            raise RepairError("no place")
        return Outcome(5.0, False, rewards=mixed(0.4))

    trials = Trials(run, 50, design=design)
    assert exactest(flag, 2.2, ALWAYS, 0, mutations, trials) == (2.2, pytest.approx(0.1))
    assert exactest(Unit((POWER,)), -1.0, ALWAYS, 0, mutations, trials) == (-1.0, pytest.approx(0.1))
    assert len(seen) == 2
    step, away = exactest(Unit((POWER,)), 2.2, ALWAYS, 0, mutations, trials)
    assert step < 2.0
    assert away == pytest.approx(0.1)
