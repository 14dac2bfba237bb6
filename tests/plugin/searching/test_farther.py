"""Farther steps on named constants: when they are tried, and on which constants."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.farther import BEARABLE, MOST
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import units
from tests.plugin.searching.test_gains import constant

GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.0, enough=9.5, online=0.0)
Reward = Callable[[Mapping[str, float]], float]  # of the factors by name


def trying(reward: Reward, *names: str, **given: object) -> tuple[Attempts, list[str]]:
    """Return the attempts on constants with these names, and the list that receives what runs."""
    ran: list[str] = []

    def run(candidate: Candidate, _: int) -> Outcome:
        factors = {one.operand.code: float(one.value) for one in candidate.mutations}
        ran.append(" ".join(f"{name}={factor:g}" for name, factor in factors.items()))
        return Outcome(reward(factors), True)

    known = units([constant(line, name) for line, name in enumerate(names, start=3)])
    return Attempts(known, mutations, (ALWAYS,), Trials(run, 200), GOAL, **given), ran  # type: ignore[arg-type]


def test_constant_with_a_small_loss_gets_a_fivefold_value() -> None:
    def reward(factors: Mapping[str, float]) -> float:
        factor = factors.get("PLAY", 1.0)
        return 10.0 if 4.0 < factor < 5.5 else -0.2 * GOAL.wanted if factor > 1.0 else -0.1

    tries, ran = trying(reward, "PLAY")
    for factor in (2.2, 0.4):
        assert not list(tries.sweep(factor, ALWAYS, tries.units))
    (found,) = list(tries.farther())[:1]
    assert [one.value for one in found.mutations] == [5.0]
    before = len(ran)
    assert not list(tries.farther())  # only once
    assert len(ran) == before


def test_constants_with_clear_effects_get_no_farther_step() -> None:
    rewards = {"BAD": -BEARABLE * GOAL.wanted - 0.1, "GOOD": 0.3 * GOAL.wanted, "IDLE": 0.0, "NEAR": -0.5}

    def reward(factors: Mapping[str, float]) -> float:
        return sum(rewards[name] for name in factors)

    tries, ran = trying(reward, *rewards)
    list(tries.each(2.2, ALWAYS, tries.units, 0))
    del ran[:]
    list(tries.farther())
    assert [one for one in ran if one.endswith("=5")] == ["NEAR=5"]


def test_six_constants_get_a_farther_step() -> None:
    names = [f"C{number}" for number in range(MOST + 2)]

    def reward(factors: Mapping[str, float]) -> float:
        return -0.1 * sum(1 + names.index(name) for name in factors)

    tries, ran = trying(reward, *names[::-1])
    list(tries.each(2.2, ALWAYS, tries.units, 0))
    del ran[:]
    list(tries.farther())
    assert ran == [f"{name}=5" for name in names[:MOST]]


@pytest.mark.parametrize(("gain", "farther"), [(2.0, ["A=5", "A=0.15"]), (0.2, [])])
def test_farther_steps_come_before_structural_changes(gain: float, farther: list[str]) -> None:
    begun: list[int] = []
    steps: list[float] = []

    def structures(_: float) -> Iterator[Candidate]:
        begun.append(len(steps))
        yield from ()

    def earned(factors: Mapping[str, float]) -> float:
        steps.extend(factors.values())
        return gain if "B" in factors else -0.1

    tries, ran = trying(
        earned, "A", "B", suggestions=Suggestions(interlude=structures, due=lambda _: len(steps) > 1)
    )
    for factor in (2.2, 0.4):
        list(tries.each(factor, ALWAYS, tries.units, 0))
    list(tries.interlude(0.0))
    assert [one for one in ran[4:] if one.startswith("A")] == farther
    assert begun == [len(ran)]


def test_parameters_of_a_structural_change_get_no_farther_step() -> None:
    tries, ran = trying(lambda factors: -0.1 * len(factors), "A", proposed=True)
    list(tries.sweep(2.2, ALWAYS, tries.units))
    list(tries.farther())
    assert ran == ["A=2.2"]


def test_a_sweep_tries_farther_steps_before_it_combines_constants() -> None:
    def reward(factors: Mapping[str, float]) -> float:
        factor = factors.get("PLAY", 1.0)
        good = 4.0 < factor < 5.5
        return 10.0 if good else 6.0 if "EASY" in factors else -1.0 if factor > 1.0 else -0.5

    found: list[str] = []

    def run(candidate: Candidate, _: int) -> Outcome:
        factors = {one.operand.code: float(one.value) for one in candidate.mutations}
        found.append(" ".join(factors))
        return Outcome(reward(factors), True)

    operands = [constant(3, "PLAY"), constant(4, "EASY")]
    search = Sweep(operands, mutations, (ALWAYS,), Trials(run, 200), GOAL)
    first = next(search.candidates())
    assert [(one.operand.code, one.value) for one in first.mutations] == [("PLAY", 5.0)]
    assert "PLAY EASY" not in found
    assert "EASY PLAY" not in found
