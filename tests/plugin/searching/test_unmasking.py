"""Constants without an effect alone are tried again under a change after which missions last longer."""

from __future__ import annotations

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from pytest_tarl.searching.unmasking import MOST, longer, unmasked
from tests.plugin.searching.test_gains import constant

TORN, WRAPPED = 10, 40  # steps
PAIRS = tuple(Pair(seed, 0.0, TORN) for seed in range(6))
GOAL = Goal(PAIRS, near=9.0, enough=9.0, online=0.0, passing=True)
PULL, TURNS, *REST = (constant(n, name) for n, name in enumerate(["PULL", "TURNS", *"ABCDEFGH"], start=1))


def wrap(candidate: Candidate, _: int) -> Outcome:
    """With too much tension, the film tears; with less, it takes half as many turns again to hold the load."""
    factors = {one.operand.code: float(one.value) for one in candidate.mutations}
    pull, turns = factors.get("PULL", 1.0), factors.get("TURNS", 1.0)
    if pull > 0.75:
        return Outcome(0.0, False, steps=TORN)
    held = 10.0 * pull * turns
    if held < 9.0 or turns > 1.9:
        return Outcome(min(held, 9.0) / 1.5, False, steps=round(WRAPPED * turns))
    return Outcome(10.0, True, steps=round(WRAPPED * turns))


def selection(trials: Trials) -> ForwardSelection:
    return ForwardSelection((), mutations, trials, GOAL, {}, 0.1)


def test_masked_constant_is_found() -> None:
    trials = Trials(wrap, 300)
    search = Sweep((*REST, TURNS, PULL), mutations, (ALWAYS,), trials, GOAL)
    found = next(search.candidates())
    assert {mutation.operand for mutation in found.mutations} == {PULL, TURNS}
    assert trials.spent < 80


@pytest.mark.parametrize(("steps", "expected"), [(TORN, False), (11, False), (12, True), (WRAPPED, True)])
def test_fifth_longer_missions_count_as_longer(steps: int, expected: bool) -> None:
    base = Joint(((Unit((PULL,)), 0.65),), ALWAYS)
    trials = Trials(lambda *_: Outcome(1.0, False, steps=steps), 9)
    trials(base.candidate(mutations), PAIRS[0].seed)
    assert longer(base, selection(trials)) is expected


def test_missions_of_unknown_length_do_not_count_as_longer() -> None:
    base = Joint(((Unit((PULL,)), 0.65),), ALWAYS)
    trials = Trials(lambda *_: Outcome(1.0, False, steps=None), 9)
    trials(base.candidate(mutations), PAIRS[0].seed)
    assert not longer(base, selection(trials))


def test_masked_constants_take_two_episodes_each() -> None:
    trials = Trials(wrap, 300)
    base, hidden = Joint(((Unit((PULL,)), 0.65),), ALWAYS), [Unit((one,)) for one in REST]
    assert not list(unmasked(base, hidden, selection(trials)))
    assert trials.spent == 1 + 2 * len(REST)


def test_at_most_a_fixed_number_of_constants_is_tried() -> None:
    many = [Unit((constant(n, f"C{n}"),)) for n in range(3, 2 * MOST)]
    trials = Trials(wrap, 300)
    assert not list(unmasked(Joint(((Unit((PULL,)), 0.65),), ALWAYS), many, selection(trials)))
    assert trials.spent == 1 + 2 * MOST


def test_good_value_between_two_extremes_is_found() -> None:
    def narrow(candidate: Candidate, seed: int) -> Outcome:
        factors = {one.operand.code: float(one.value) for one in candidate.mutations}
        turns = factors.get("TURNS", 1.0)
        if factors.get("PULL", 1.0) > 0.75:
            return Outcome(0.0, False, steps=TORN)
        good = 1.7 < turns < 1.85
        return Outcome(
            10.0 if good else 4.0 + (turns if turns < 2.0 else 0.0), good, steps=round(WRAPPED * turns)
        )

    base = Joint(((Unit((PULL,)), 0.65),), ALWAYS)
    found = next(unmasked(base, [Unit((TURNS,))], selection(Trials(narrow, 300))))
    assert [1.7 < float(one.value) < 1.85 for one in found.mutations if one.operand == TURNS] == [True]
