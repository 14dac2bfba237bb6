"""If every other value of a constant is worse, the constant follows a sensor that varies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import pytest

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection
from pytest_tarl.searching.laws import CONSTANTS, laws
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials, operand_effect
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant

PAIRS = tuple(Pair(seed, 2.0, 100) for seed in range(6))
GOAL = Goal(PAIRS, near=9.0, enough=9.0, online=2.0)
LIGHT, OTHER = constant(1, "LIGHT"), constant(2, "OTHER")
FORM = Form(template(SHIPPED / "follows.toml"), variable="distance", parameter="power")
FORM = replace(FORM, defaults=(("power", 1.0), ("usual", 10.0)))


def run(candidate: Candidate, seed: int, right: float = 1.7) -> Outcome:
    """Return 10 with the right power, less with others; any change of the value itself loses."""
    total = 2.0
    for one in candidate.mutations:
        if one.form is None:
            total -= 4.0
        elif one.operand == LIGHT:
            total = 10.0 - 5.0 * abs(float(one.value) - right)
    return Outcome(total, total > 0.0)


def proportional(used: Sequence[Operand]) -> Iterator[Candidate]:
    yield Candidate(tuple(Mutation(one, 1.0, form=FORM) for one in used), ALWAYS)


@pytest.mark.parametrize("right", [1.7, -1.2, 0.6])
def test_the_exponent_that_gains_is_adjusted(right: float) -> None:
    trials = Trials(lambda candidate, seed: run(candidate, seed, right), 60)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.7)
    (found,) = laws([Unit((OTHER,)), Unit((LIGHT,))], proportional, selection)
    ((mutation),) = found.mutations
    assert mutation.operand == LIGHT
    assert mutation.value == pytest.approx(right, abs=0.2)
    assert operand_effect(mutation, 8.0).what == "LIGHT follows distance"


def test_exponent_without_gain_is_dropped() -> None:
    trials = Trials(run, 60)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.7)
    many = [Unit((constant(n, f"C{n}"),)) for n in range(3, 10)]
    assert list(laws(many, proportional, selection)) == []
    assert trials.spent == 2 * CONSTANTS


def test_best_law_is_adjusted_first() -> None:
    slight = constant(3, "SLIGHT")

    def total(candidate: Candidate, seed: int) -> Outcome:
        ((one),) = candidate.mutations
        return Outcome(3.0, True) if one.operand == slight else run(candidate, seed)

    trials = Trials(total, 60)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.7)
    found = next(laws([Unit((slight,)), Unit((slight,)), Unit((LIGHT,))], proportional, selection))
    assert found.mutations[0].operand == LIGHT
    assert trials.labels.count(trials.labels[0]) == 1
    assert len({*trials.labels[:4]}) == 4


def test_large_exponent_is_reduced_for_hard_missions() -> None:
    def hard(candidate: Candidate, seed: int) -> Outcome:
        power = max(float(one.value) for one in candidate.mutations)
        return Outcome(0.0 if seed == 4 and power > 1.6 else min(10.0, 6.0 + 2.2 * power), True)

    trials = Trials(hard, 60)
    selection = ForwardSelection((), mutations, trials, GOAL, {}, 0.7)
    ((mutation),) = next(laws([Unit((LIGHT,))], proportional, selection)).mutations
    assert 1.3 < float(mutation.value) <= 1.6


def test_laws_are_tried_if_raising_and_lowering_lose() -> None:
    trials = Trials(run, 40)
    sweep = Sweep(
        (OTHER, LIGHT), mutations, (ALWAYS,), trials, GOAL, suggestions=Suggestions(proportional=proportional)
    )
    found = next(sweep.candidates())
    assert [one.form for one in found.mutations] == [FORM]
