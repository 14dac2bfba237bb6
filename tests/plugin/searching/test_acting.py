"""A constant that changes only what a node publishes matters as well while all failing missions look alike."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.repairing.between import factor
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.acting import Acting
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import constant

LOST, STEPS = -4.0, 100
TEETH = constant(3, "TEETH", 20.0)
INERT = [constant(line, f"C{line}", 2.0) for line in range(4, 16)]
PAIRS = tuple(Pair(seed, LOST, STEPS) for seed in range(8))
GOAL = Goal(PAIRS, near=9.0, enough=9.5, online=LOST, passing=True)


def run(candidate: Candidate, seed: int) -> Outcome:
    """Succeed with 0.77 to 0.83 of the teeth; otherwise fail alike, with other commands for other numbers of teeth."""
    by = {one.operand: factor(one) or 1.0 for one in candidate.mutations}.get(TEETH, 1.0)
    won = 0.77 < by < 0.83
    return Outcome(10.0 if won else LOST, won, steps=STEPS, outputs=(("/motor", (seed + by, 2.0)),))


def unchanged(seed: int) -> Outcome:
    return run(Candidate((), ALWAYS), seed)


@pytest.mark.parametrize("observed", [True, False])
def test_command_only_constant_gets_small_steps_first(observed: bool) -> None:
    trials = Trials(run, 300, unchanged=unchanged if observed else None)
    found = next(Sweep([*INERT, TEETH], mutations, (ALWAYS,), trials, GOAL).candidates(), None)
    assert (found is not None and trials.spent <= 2 * (len(INERT) + 1) + 14) is observed
    assert not observed or (found is not None and found.mutations[0].operand == TEETH)


def test_unchanged_program_runs_once_per_seed() -> None:
    trials = Trials(run, 300, unchanged=unchanged)
    acting, teeth, inert = Acting(trials, GOAL), Unit((TEETH,)), Unit((INERT[0],))
    assert not acting(teeth)
    for unit in (teeth, inert):
        for by, seed in ((2.2, 0), (0.4, 1)):
            candidate = Candidate(unit.mutations(mutations, by), ALWAYS)
            trials(candidate, seed)
            acting.ran(unit, candidate)
    assert (acting(teeth), acting(inert), acting(teeth)) == (True, False, True)
    assert trials.beside == 2


def test_different_commands_are_an_effect_while_nothing_gains() -> None:
    named, other = Unit((TEETH,)), Unit((INERT[0],))
    gains = Gains(0.5, acting=lambda unit: unit == named)
    for unit in (named, other):
        for by in (2.2, 0.4):
            gains.enter((unit, ALWAYS), by, 0.0, moved=False)
    assert gains.lost_both_ways(ALWAYS, [named, other], (2.2, 0.4)) == [named]
    assert gains.moving([named, other]) == [named]
    assert (gains.matters(named), gains.matters(other), gains.moves(named)) == (True, False, False)
    gains.enter((Unit((INERT[1],)), ALWAYS), 2.2, 5.0)
    assert gains.moving([named, other]) == []
    assert (gains.anything(), gains.anything(6.0)) == (True, False)
