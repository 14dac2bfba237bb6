"""A small change of one constant comes before a large change of another one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.smaller import EPISODES, size, smaller
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

STEADY = (1.0,) * 10
LATE = (0.0,) * 5 + (2.0,) * 5
Range = tuple[float, float]


def named(line: int, code: str, value: float = 2.0) -> Operand:
    made = operand(line, code, value)
    site = replace(made.site, qualname=f"function_{line}")
    return replace(made, site=site, definition=operand(line + 40, code, value).span)


HOTTEST, TARGET, TAU = named(3, "HOTTEST"), named(4, "TARGET"), named(5, "TAU")


def searched(
    operands: Sequence[Operand],
    windows: Mapping[Operand, Range],
    rewards: Mapping[Operand, tuple[float, ...]] | None = None,
    budget: int = 300,
) -> Sweep:
    """A world that any of some operands restores, by a factor in its window; `rewards` are the missions' then."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        (change,) = candidate.mutations
        low, high = windows.get(change.operand, (math.inf, math.inf))
        if low <= change.value <= high:
            return Outcome(10.0, True, rewards=(rewards or {}).get(change.operand, STEADY))
        return Outcome(-0.01 * abs(math.log(abs(change.value))), False, rewards=(0.0,) * 10)

    def design(seed: int) -> Outcome:
        return Outcome(10.0, True, rewards=STEADY)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True)
    return Sweep(operands, mutations, (ALWAYS,), Trials(run, budget, design=design), goal)


def order(search: Sweep, many: int) -> list[Operand]:
    found = search.candidates()
    return [next(found).mutations[0].operand for _ in range(many)]


def test_a_sixth_less_of_another_constant_comes_before_a_doubled_one() -> None:
    windows = {HOTTEST: (2.0, 2.4), TARGET: (0.8, 0.85)}
    assert order(searched((TARGET, TAU, HOTTEST), windows), 2) == [TARGET, HOTTEST]
    assert order(searched((HOTTEST, TAU, TARGET), windows), 2) == [TARGET, HOTTEST]  # not tried before


def test_a_small_change_with_which_missions_go_less_as_designed_does_not_come_first() -> None:
    windows = {HOTTEST: (2.0, 2.4), TARGET: (0.8, 0.85)}
    assert order(searched((TARGET, TAU, HOTTEST), windows, {TARGET: LATE}), 1) == [HOTTEST]


def test_a_repair_found_late_is_not_compared() -> None:
    windows = {HOTTEST: (2.0, 2.4), TARGET: (0.8, 0.85)}
    late = searched((TARGET, TAU, HOTTEST), windows, budget=15)
    assert order(late, 1) == [HOTTEST]


def test_the_search_for_smaller_changes_takes_few_episodes_if_there_is_none() -> None:
    many = tuple(named(at, f"LIMIT_{at}") for at in range(10, 30))
    search = searched((HOTTEST, *many), {HOTTEST: (2.0, 2.4)})
    assert order(search, 1) == [HOTTEST]
    confirming = 6
    assert search.trials.spent == confirming + EPISODES + search.trials.beside


def test_only_named_constants_that_matter_are_changed_and_by_much_less() -> None:
    units = [Unit((one,)) for one in (HOTTEST, TARGET, TAU, operand(6, "1.5", 1.5))]
    gains = Gains(0.1)
    for unit, gain in zip(units, (9.0, -1.0, 0.0, 2.0), strict=True):
        for factor in (2.2, 0.4):
            gains.enter((unit, ALWAYS), factor, gain)
    assert smaller(units[0], 2.2, units, gains, ALWAYS) == [(units[1], by) for by in (0.82, 1.22, 0.74, 1.33)]
    assert smaller(units[0], 1.5, units, gains, ALWAYS) == [(units[1], 0.82), (units[1], 1.22)]
    assert smaller(units[0], 1.3, units, gains, ALWAYS) == []


def test_the_size_of_a_change_is_that_of_the_value() -> None:
    share = named(3, "SHARE", 0.95)
    assert size(Unit((share,)), 0.5) == pytest.approx(math.log(2.0))
    assert size(Unit((share,), SHARE), 5.0) == pytest.approx(math.log(0.99 / 0.95))
    assert size(Unit((share,)), -1.0) == size(Unit((named(3, "START", 0.0),)), 2.2) == math.inf


def test_a_small_step_that_earns_nearly_enough_is_moved_a_little() -> None:
    """Friction is wrong by 29 %: a step of 22 % earns a bit too little, and one of 33 % misses."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        (change,) = candidate.mutations
        if change.operand == HOTTEST and 2.0 <= change.value <= 2.4:
            return Outcome(10.0, True)
        away = abs(math.log(abs(change.value) / 1.29)) if change.operand == TARGET else 1.0
        return Outcome(10.0 - 12.0 * away if away < 0.06 else -0.01 * away, away < 0.06)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(8)), near=9.0, enough=9.5, online=0.0, passing=True)
    search = Sweep((TARGET, TAU, HOTTEST), mutations, (ALWAYS,), Trials(run, 300), goal)
    (change,) = next(search.candidates()).mutations
    assert change.operand == TARGET
    assert change.value == pytest.approx(1.22 * 1.06, rel=0.002)
