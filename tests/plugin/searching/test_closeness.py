"""Of repairs with equal reward, the one whose missions are most like designed ones comes first."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.calls_apart import calls_of
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.closeness import rivals
from pytest_tarl.searching.course import deviation
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

STEADY = (1.0,) * 10
LATE = (0.0,) * 5 + (2.0,) * 5


def named(line: int, code: str, qualname: str = "heat") -> Operand:
    made = operand(line, code, 2.0)
    return replace(
        made, site=replace(made.site, qualname=qualname), definition=operand(line + 40, code, 2.0).span
    )


LEAK, POWER, ROOM = named(3, "LEAK"), named(4, "POWER"), named(5, "ROOM")
ELSEWHERE = named(6, "ELSEWHERE", "cool")


def test_later_reward_counts_as_a_larger_deviation() -> None:
    assert deviation(STEADY, STEADY) == 0.0
    assert deviation(LATE, STEADY) == pytest.approx(2.5 / 10)
    assert deviation((), STEADY) == pytest.approx(0.55)
    assert deviation(STEADY, (*STEADY, 0.0)) == 0.0
    assert deviation(STEADY, (0.0, 0.0)) == 0.0


def test_alternative_constants_have_the_scale_of_the_repaired_constant() -> None:
    units = [Unit((LEAK,)), Unit((POWER,)), Unit((POWER,), SHARE)]
    tried = {unit for unit, _ in rivals(units[0], 2.0, units, Gains(0.1), ALWAYS)}
    assert tried == {units[1]}
    getter = Unit((replace(LEAK, site=replace(LEAK.site, qualname="Kiln.p", text="return self.value")),))
    call = operand(9, 'self.p("power")', 0.9)
    assert calls_of(getter, [getter, Unit((call,)), Unit((call,), SHARE)]) == [Unit((call,))]


def test_alternatives_are_effective_constants_of_the_same_function() -> None:
    gains = Gains(0.1)
    for at, gain in ((LEAK, 9.0), (POWER, 0.3), (ROOM, 0.0), (ELSEWHERE, 1.0)):
        for factor in (2.2, 0.4):
            gains.enter((Unit((at,)), ALWAYS), factor, gain)
    units = [Unit((one,)) for one in (LEAK, POWER, ROOM, ELSEWHERE)]
    found = list(rivals(units[0], 1.25, units, gains, ALWAYS))
    assert found == [
        (units[3], 1.25),
        (units[1], 0.8),
        (units[1], 1.25),
    ]  # first the one that gained elsewhere
    gains.enter((units[1], ALWAYS), 0.8, 0.3)
    found = list(rivals(units[0], 1.25, units, gains, ALWAYS))
    assert found[3:] == [(units[1], 0.855), (units[1], 1.169)]  # it gained, so a weaker factor may suffice
    assert list(rivals(units[0], -1.0, units, gains, ALWAYS)) == []


@pytest.mark.parametrize(("late", "first"), [(True, POWER), (False, LEAK)])
def test_most_faithful_constant_comes_first(late: bool, first: Operand) -> None:
    def factor(mutation: Mutation, of: Operand) -> float:
        return float(mutation.value) if mutation.operand == of else 1.0

    def run(candidate: Candidate, seed: int) -> Outcome:
        (change,) = candidate.mutations
        leak, power = factor(change, LEAK), factor(change, POWER)
        if 1.4 < leak < 1.6:
            return Outcome(10.0, True, rewards=LATE if late else STEADY)
        if 0.6 < power < 0.7 and (1 / power) != pytest.approx(1 / 0.65):
            return Outcome(10.0, True, rewards=STEADY)
        return Outcome(abs(math.log(leak * power)) / 10, False, rewards=(0.0,) * 10)

    pairs = tuple(Pair(seed, 0.0) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=0.0, passing=True)
    trials = Trials(run, 300, design=lambda _: Outcome(10.0, True, rewards=STEADY))
    search = Sweep((LEAK, POWER), mutations, (ALWAYS,), trials, goal)
    found = next(search.candidates())
    assert found.mutations[0].operand == first
    assert trials.beside in ((3,) if late else (1,))
