"""Values between two with which missions fail for different reasons."""

from __future__ import annotations

from dataclasses import replace
from math import log

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.attempts import Attempts
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.failing_otherwise import MOST, STEPS, in_between
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import units
from tests.plugin.searching.test_search import operand

FORCE, IDLE = operand(3, "60.0", 60.0), operand(4, "7.0", 7.0)
GOAL = Goal((Pair(5, -4.0, 40),), near=8.0, enough=7.0, online=-4.0, passing=True)


class Sander:
    """Wood that needs a force between two bounds: more clogs the paper, less leaves lacquer."""

    def __init__(self, low: float, high: float, *, reasons: tuple[str, str] = ("lacquer", "clogged")) -> None:
        self.low, self.high, self.reasons = low, high, reasons
        self.forces: list[float] = []

    def __call__(self, candidate: Candidate, _: int) -> Outcome:
        (mutation,) = candidate.mutations
        if mutation.operand == IDLE:
            return Outcome(-4.0, False, steps=40, failure=self.reasons[1])
        force = float(mutation.value)
        self.forces.append(force)
        if self.low <= force <= self.high:
            return Outcome(9.0, True, steps=50)
        return Outcome(-4.1, False, steps=39, failure=self.reasons[force > self.high])


def search(world: Sander, *factors: float, idle: bool = True, goal: Goal = GOAL) -> Attempts:
    made = Attempts(units((FORCE, IDLE)), mutations, (ALWAYS,), Trials(world, 100), goal)
    for unit in made.units:
        if idle or unit.operands[0] == FORCE:
            for factor in factors:
                list(made.attempt(unit, ALWAYS, factor, 0))
    world.forces.clear()
    return made


def test_force_between_two_extremes_is_found() -> None:
    world = Sander(27.0, 33.0)
    (found,) = in_between(made := search(world, 2.2, 0.4), ALWAYS, made.units)
    assert float(found.mutations[0].value) == pytest.approx(60.0 * 0.4**0.75, rel=0.02)
    assert world.forces == pytest.approx([60.0 * 0.4**0.5, 60.0 * 0.4**0.75], rel=0.02)


@pytest.mark.parametrize(("low", "high"), [(24.5, 25.5), (56.0, 58.0), (36.7, 37.0)])
def test_each_step_halves_the_good_interval(low: float, high: float) -> None:
    world = Sander(low, high)
    list(in_between(made := search(world, 0.4), ALWAYS, made.units))
    assert len(world.forces) == STEPS
    width = log(1.0 / 0.4)
    for force in world.forces:
        width /= 2
        assert abs(log(force / ((low + high) / 2))) <= width + 0.05


@pytest.mark.parametrize(
    ("reasons", "idle", "goal"),
    [
        (("clogged", "clogged"), True, GOAL),
        (("", "clogged"), True, GOAL),
        (("lacquer", ""), True, GOAL),
        (("lacquer", "clogged"), False, GOAL),
        (("lacquer", "clogged"), True, replace(GOAL, passing=False)),
    ],
    ids=[
        "same reason",
        "unknown",
        "unknown without a change",
        "nothing without effect",
        "failures do not count",
    ],
)
def test_nothing_is_tried_without_two_known_reasons(reasons: tuple[str, str], idle: bool, goal: Goal) -> None:
    world = Sander(27.0, 33.0, reasons=reasons)
    made = search(world, 2.2, 0.4, idle=idle, goal=goal)
    assert list(in_between(made, ALWAYS, made.units)) == []
    assert world.forces == []


def test_only_the_constants_with_the_nearest_values_are_tried() -> None:
    forces = [operand(10 + at, f"{60.0 + at}", 60.0 + at) for at in range(MOST + 3)]
    tried: set[int] = set()

    def run(candidate: Candidate, _: int) -> Outcome:
        (mutation,) = candidate.mutations
        line = mutation.operand.span.line
        tried.add(line)
        if line < 10:
            return Outcome(-4.0, False, steps=40, failure="clogged")
        return Outcome(-4.1, False, steps=39, failure="lacquer")

    made = Attempts(units((IDLE, *forces)), mutations, (ALWAYS,), Trials(run, 400), GOAL)
    for at, unit in enumerate(made.units):
        list(made.attempt(unit, ALWAYS, 0.4 + 0.05 * at, 0))
    tried.clear()
    list(in_between(made, ALWAYS, made.units))
    assert tried == {10 + at for at in range(3, MOST + 3)}
