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
