"""If a repair changes the course of missions, constants that restore the designed course come first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.gentler import gentler
from pytest_tarl.searching.plainness import Oddness, oddness, of_nature, writing
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_search import operand

STEPS = 100  # of a designed mission
Range = tuple[float, float]


def named(line: int, code: str, value: float, text: str = "") -> Operand:
    made = operand(line, code, value)
    site = replace(made.site, text=text or made.site.text)
    return replace(made, site=site, definition=operand(1, code, value).span)


def factor(mutation: Mutation) -> float:
    value, was = float(mutation.value), float(mutation.operand.value or 1)
    return value / was if mutation.operand.literal else value


BRAKE = "return max(0.2, PADS - GRAVITY * slope)"
CRUISE = named(3, "CRUISE", 4.0)
PADS = named(5, "PADS", 2.4, BRAKE)
GRAVITY = replace(named(5, "GRAVITY", 9.81, BRAKE), span=operand(6, "GRAVITY", 9.81).span)
REACTION = named(8, "REACTION", 0.15)


def searched(
    operands: Sequence[Operand], windows: Mapping[Operand, Range], steps: Mapping[Operand, int] | None = None
) -> Sweep:
    """Search a world that any operand restores by a factor in its window; `steps` are the mission lengths then."""
    lengths = steps or {}

    def run(candidate: Candidate, seed: int) -> Outcome:
        restored = False
        length = STEPS
        for one in candidate.mutations:
            low, high = windows.get(one.operand, (math.inf, math.inf))
            restored = restored or low <= factor(one) <= high
            length = lengths.get(one.operand, STEPS)
        moved = sum(0.01 * math.log(abs(factor(one)) + 0.1) for one in candidate.mutations)
        return Outcome(10.0 if restored else moved, restored, steps=length)

    pairs = tuple(Pair(seed, 0.0, STEPS) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=0.0, passing=True, steps=float(STEPS))
    return Sweep(operands, mutations, (ALWAYS,), Trials(run, 300), goal)


def order(search: Sweep, many: int) -> list[Operand]:
    found = search.candidates()
    return [next(found).mutations[0].operand for _ in range(many)]


@pytest.mark.parametrize("value", [9.81, -9.81, 9.80665, 9.8, 3.14159, math.pi, 3.14, 6.2832])
def test_the_search_moves_constants_of_nature_last(value: float) -> None:
    constant = named(4, "G", value)
    assert of_nature(constant)
    assert writing(constant) is oddness([Mutation(constant, 2.2)]) is Oddness.NATURE
    assert sorted([constant, operand(3, "0.0", 0.0), CRUISE], key=writing)[-1] == constant


@pytest.mark.parametrize("value", [9.5, 10.0, 3.1, 3.2, 1.57, 0.0, 6.0, 12.57])
def test_only_physical_numbers_are_constants_of_nature(value: float) -> None:
    assert not of_nature(named(4, "LIMIT", value))
    assert not of_nature(replace(operand(4, "True", 1.0), value=True))


def test_another_constant_of_the_function_is_corrected_before_gravity() -> None:
    search = searched((PADS, GRAVITY, CRUISE), {GRAVITY: (1.8, 2.5), PADS: (0.69, 0.78)})
    assert order(search, 2) == [PADS, GRAVITY]


def test_repair_with_longer_missions_comes_later() -> None:
    windows = {CRUISE: (0.3, 0.5), PADS: (0.6, 0.7)}
    slow = searched((REACTION, PADS, CRUISE), windows, {CRUISE: 3 * STEPS})
    assert order(slow, 2) == [PADS, CRUISE]
    as_designed = searched((REACTION, PADS, CRUISE), windows)
    assert order(as_designed, 1) == [CRUISE]


def test_search_for_a_gentler_repair_is_short() -> None:
    many = tuple(named(at, f"LIMIT_{at}", 2.0) for at in range(10, 18))
    kept = searched((*many, CRUISE), {CRUISE: (0.3, 0.5)})
    slow = searched((*many, CRUISE), {CRUISE: (0.3, 0.5)}, {CRUISE: 3 * STEPS})
    assert order(kept, 1) == order(slow, 1) == [CRUISE]
    assert slow.attempts.trials.spent <= kept.attempts.trials.spent + 12


def test_getter_repair_changes_only_needed_calls() -> None:
    getter = named(3, "self.get(name).value", 1.0, "return self.get(name).value")
    getter = replace(getter, site=replace(getter.site, qualname="Cell.p"))
    feed, tension, speed = (
        replace(operand(at, f"self.p('{name}')", 1.0), definition=operand(1, "1", 1.0).span)
        for at, name in enumerate(("feed", "tension", "speed"), 5)
    )

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: factor(one) for one in candidate.mutations}
        right = all(2.0 < by.get(one, by.get(getter, 1.0)) < 2.5 for one in (feed, tension))
        return Outcome(10.0 if right else -0.1 * len(by), right)

    pairs = tuple(Pair(seed, 0.0) for seed in range(8))
    goal = Goal(pairs, near=9.0, enough=9.5, online=0.0, passing=True)
    search = Sweep((getter, feed, tension, speed), mutations, (ALWAYS,), Trials(run, 300), goal)
    found = search.candidates()
    first, second = next(found), next(found)
    assert [one.operand for one in first.mutations] == [feed, tension]
    assert [one.operand for one in second.mutations] == [getter]


def test_equal_endings_mean_alike_candidates() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        other = candidate.mutations[0].operand is REACTION
        return Outcome(float(seed), passed=True, steps=STEPS + (other and seed == 3))

    trials = Trials(run, 100)
    one, two, other = (Candidate((Mutation(each, 2.0),), ALWAYS) for each in (CRUISE, PADS, REACTION))
    for seed in range(5):
        for candidate in (one, two, other):
            trials(candidate, seed)
    assert trials.same_as(one, two) == 5
    assert trials.same_as(one, other) == 0
    assert trials.same_as(one, Candidate((Mutation(GRAVITY, 2.0),), ALWAYS)) == 0


def test_constant_is_no_alternative_to_itself() -> None:
    found, other = Unit((PADS,)), Unit((CRUISE,))
    units = [found, Unit((PADS,), SHARE), other]
    assert [unit for unit, _ in gentler(found, units, Gains(0.1), ALWAYS, 1.0)] == [other]
