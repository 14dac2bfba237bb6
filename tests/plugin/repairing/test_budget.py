"""The budget of a search is a hard limit: its phases together never exceed it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pytest_tarl.model import Guard
from pytest_tarl.patching.mutate import Mutation
from pytest_tarl.repairing.budget import Purse
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.search import BudgetSpentError, Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import GAIN
from tests.plugin.tank import ONLINE, RECORD, changed, result
from tests.slow import SLOW


@settings(max_examples=200, deadline=None)
@given(
    st.integers(1, 60),
    st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 80), st.integers(0, 10)), max_size=6),
)
def test_the_phases_of_a_repair_never_exceed_the_budget(
    budget: int, phases: list[tuple[float, int, int]]
) -> None:
    ran = 0

    def run(candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        nonlocal ran
        ran += 1
        return Outcome(0.0, passed=True)

    order = SimpleNamespace(drift="mud", progress=lambda *_: None)
    mutants: Any = SimpleNamespace(order=order, run=run, foresee=lambda *_: None)
    watch: Any = SimpleNamespace(progress=lambda _: "", saw=lambda *_: None)
    purse, charged = Purse(budget), 0
    for share, asked, beside in phases:
        trials = purse.phase(mutants, "sweep", watch, share)
        try:
            for _ in range(beside):
                trials.charge()
                charged += 1
            for seed in range(asked):
                trials(Candidate((Mutation(GAIN, 3.0),), Guard()), seed)
        except BudgetSpentError:
            pass
        purse.settle(trials)
        assert ran + charged == purse.spent <= budget


def test_each_phase_has_its_share_of_the_remaining_time(monkeypatch: pytest.MonkeyPatch) -> None:
    now, told = [100.0], []
    monkeypatch.setattr("pytest_tarl.repairing.budget.monotonic", lambda: now[0])
    order = SimpleNamespace(drift="mud", progress=lambda *one: told.append(one))
    mutants: Any = SimpleNamespace(
        order=order, run=lambda *_: Outcome(0.0, passed=True), foresee=lambda *_: None
    )
    watch: Any = SimpleNamespace(progress=lambda method: f"by {method}", saw=lambda *_: None)
    purse = Purse(1000, seconds=40.0)
    now[0] = 108.0  # 32 s are left, a quarter of them is 8 s
    trials = purse.phase(mutants, "sweep", watch, 0.25)
    candidate = Candidate((Mutation(GAIN, 3.0),), Guard())
    now[0] = 115.5
    trials(candidate, 1)
    now[0] = 116.0
    trials(candidate, 2)
    assert told == [(15, 16, "by sweep"), (16, 16, "by sweep")]
    assert not purse.late
    now[0] = 116.5
    with pytest.raises(BudgetSpentError):
        trials(candidate, 3)
    assert purse.late
    trials(candidate, 2)  # a known outcome needs no time


def test_phase_without_a_time_limit_shows_its_episodes() -> None:
    told: list[Any] = []
    order = SimpleNamespace(drift="mud", progress=lambda *one: told.append(one))
    ran: list[Any] = []

    def run(candidate: Candidate, seed: int, drift: str | None) -> Outcome:
        ran.append((candidate.mutations != (), seed, drift))
        return Outcome(0.0, passed=True)

    mutants: Any = SimpleNamespace(order=order, run=run, foresee=lambda *_: None)
    watch: Any = SimpleNamespace(progress=lambda method: method, saw=lambda *one: told.append(one[1]))
    purse = Purse(100)
    purse.spent = 40
    trials = purse.phase(mutants, "sweep", watch, 0.5)
    candidate = Candidate((Mutation(GAIN, 3.0),), Guard())
    trials(candidate, 8)
    trials(candidate, 9)
    assert told == [(0, 30, "sweep"), 8, (1, 30, "sweep"), 9]
    assert trials.design is not None
    assert trials.unchanged is not None
    trials.design(5)
    trials.unchanged(6)
    assert ran == [(True, 8, "mud"), (True, 9, "mud"), (False, 5, None), (False, 6, "mud")]
    purse.settle(trials)
    assert purse.spent == 42


@pytest.mark.parametrize(("gained", "episodes"), [(7.0, 13), (5.0, 10)])
def test_part_of_the_budget_is_reserved_for_promising_constants(gained: float, episodes: int) -> None:
    pairs = tuple(Pair(seed, 0.0) for seed in range(40))
    goal = Goal(pairs, near=9.5, enough=10.0, online=0.0)
    trials = Trials(lambda *_: Outcome(gained, passed=True), 10, reserve=3, worth=goal)
    for seed in range(episodes):
        trials(Candidate((Mutation(GAIN, 3.0),), Guard()), seed)
    with pytest.raises(BudgetSpentError):
        trials(Candidate((Mutation(GAIN, 3.0),), Guard()), episodes)
    assert len(trials.totals) == episodes


FLAGS = ((), ("--tarl-constants",), ("--tarl-search=halving",), ("--tarl-search=epsilon-greedy",))


@pytest.mark.parametrize("flags", FLAGS if SLOW else FLAGS[:1])
def test_a_run_that_finds_nothing_stays_within_its_budget(
    tank: pytest.Pytester, flags: tuple[str, ...]
) -> None:
    changed(tank, "test_tank", "0.1 * pump * (", "0.1 * (0.0 if tarl_drift else 1.0) * pump * (")
    tank.runpytest(*RECORD).assert_outcomes(passed=1, deselected=1)
    for budget in (1, 23, 90) if SLOW else (7,):
        tank.runpytest(*ONLINE, "--tarl-repair", f"--tarl-budget={budget}", *flags)
        found = result(tank)
        assert 0 < found["episodes"]["search"] <= budget
        assert not found["repair"]["accepted"]
