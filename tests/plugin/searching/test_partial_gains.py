"""A change that restores a part of the missions is held while the other constants are tried."""

from __future__ import annotations

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.partial_gains import EPISODES, SEEDS, held
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import constant

EASY, HARD = 0, 1
GOAL = Goal(tuple(Pair(seed, 0.0, 10) for seed in range(6)), near=9.0, enough=9.0, online=0.0, passing=True)
GAIN, DAMPING, *REST = (constant(n, name) for n, name in enumerate(["GAIN", "DAMPING", *"ABCDEFGH"], start=1))
BASE = Joint(((Unit((GAIN,)), 2.2),), ALWAYS)
OTHERS = [Unit((one,)) for one in (*REST, DAMPING)]


def swings(candidate: Candidate, seed: int) -> Outcome:
    """A larger gain restores easy missions; hard ones need more damping as well, which alone is a loss."""
    by = {one.operand: float(one.value) for one in candidate.mutations}
    gain, damping = by.get(GAIN, 1.0) >= 1.4, by.get(DAMPING, 1.0)
    if not gain:
        return Outcome(0.0 if damping == 1.0 else -2.0, False, steps=10)
    if seed == EASY or damping >= 2.0:
        return Outcome(10.0, True, steps=10)
    return Outcome(2.0 if damping == 1.0 else 5.0 if damping > 1.0 else 1.0, False, steps=10)


def selection(trials: Trials) -> ForwardSelection:
    return ForwardSelection((), mutations, trials, GOAL, {}, 0.5)


def factors(joint: Joint) -> dict[str, float]:
    return {unit.operands[0].code: factor for unit, factor in joint.parts}


def test_constant_is_found_while_another_change_is_applied() -> None:
    trials = Trials(swings, 300)
    found = [(factors(joint), one.total) for joint, one in held(BASE, OTHERS, selection(trials))]
    assert found == [({"GAIN": 2.2, "DAMPING": 2.2}, 10.0)]
    assert trials.spent <= SEEDS + EPISODES


def test_helpful_constant_is_moved_further() -> None:
    def wide(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        if seed == EASY:
            return Outcome(10.0, True)
        return Outcome(min(2.0 * by.get(DAMPING, 1.0), 10.0), False)

    found = [(factors(joint), one.total) for joint, one in held(BASE, OTHERS, selection(Trials(wide, 300)))]
    assert found == [({"GAIN": 2.2, "DAMPING": 3.3}, 6.6)]


def test_equally_good_constants_all_move_further() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        if seed == EASY:
            return Outcome(10.0, True)
        (other, value), *_ = [*((one, at) for one, at in by.items() if one != GAIN), (GAIN, 1.0)]
        # `A` helps first, and a little less than DAMPING, whose best value lies inside its first step
        helps = {
            REST[0]: 5.0 if value > 2.0 else 2.0,
            DAMPING: 9.5 if 0.5 < value < 0.9 else 5.2 if value < 0.5 else 2.0,
        }
        return Outcome(helps.get(other, 2.0), False)

    found = [(factors(joint), one.total) for joint, one in held(BASE, OTHERS, selection(Trials(run, 300)))]
    assert found == [({"GAIN": 2.2, "DAMPING": 0.6}, 9.5), ({"GAIN": 2.2, "A": 2.2}, 5.0)]


@pytest.mark.parametrize(
    ("easy", "hard", "spent"),
    [
        (10.0, 10.0, SEEDS),  # nothing is left to gain
        (2.0, 2.0, SEEDS),  # too small a part of the loss
        (9.5, -9.0, SEEDS),  # what one mission gains, another loses
        (10.0, 2.0, SEEDS + EPISODES),
    ],
)
def test_change_stays_applied_if_it_gains_on_average(easy: float, hard: float, spent: int) -> None:
    trials = Trials(lambda _, seed: Outcome(easy if seed == EASY else hard, seed == EASY or hard > 9.0), 300)
    many = [Unit((constant(n, f"C{n}"),)) for n in range(3, 3 + EPISODES)]
    assert list(held(BASE, many, selection(trials))) == []
    assert trials.spent == spent


def test_changes_that_cannot_be_written_are_skipped() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        if len(candidate.mutations) > 1:
            raise RepairError("no place")
        return swings(candidate, seed)

    def never(candidate: Candidate, _: int) -> Outcome:
        raise RepairError("no place")

    assert list(held(BASE, OTHERS, selection(Trials(run, 300)))) == []
    assert list(held(BASE, OTHERS, selection(Trials(never, 300)))) == []


def test_other_constants_are_tried_before_larger_steps() -> None:
    trials = Trials(swings, 300)
    found = next(Sweep((*REST, DAMPING, GAIN), mutations, (ALWAYS,), trials, GOAL).candidates())
    assert {one.operand for one in found.mutations} == {GAIN, DAMPING}
    assert trials.spent < 60


def test_other_constants_replace_a_refused_first_change() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: float(one.value) for one in candidate.mutations}
        if by.get(REST[0], 1.0) >= 1.4 and by.get(DAMPING, 1.0) >= 2.0:
            return Outcome(10.0, True, steps=10)
        return swings(candidate, seed)

    sweep = Sweep((*REST, DAMPING, GAIN), mutations, (ALWAYS,), trials := Trials(run, 300), GOAL).candidates()
    assert {one.operand for one in next(sweep).mutations} == {GAIN, DAMPING}
    refused = trials.spent
    found = next(one for one in sweep if GAIN not in {each.operand for each in one.mutations})
    assert {one.operand for one in found.mutations} == {REST[0], DAMPING}
    assert trials.spent - refused < 60
