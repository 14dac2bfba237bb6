"""A candidate that loses much of the margin gets a better value before its test; others stay unchanged."""

from __future__ import annotations

from dataclasses import replace
from math import log

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.patching.structures import Form
from pytest_tarl.patching.templates import SHIPPED, template
from pytest_tarl.repairing.between import factor, stronger
from pytest_tarl.repairing.centring import BEHIND, SEEDS, THIN, centred, moved
from pytest_tarl.repairing.ledger import Ledger
from pytest_tarl.searching.accept import Outcome, Reference
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from tests.plugin.searching.test_search import operand

REFERENCE = Reference((10.0, 10.0), 1.0, 0.5, 0.0)
GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(5)), near=9.0, enough=9.5, online=0.0, passing=True)
LITERAL = operand(3, "2.0", 2.0)
NAMED = replace(operand(4, "GAIN", 2.0), definition=operand(1, "2.0", 2.0).span)


def world(best: float, width: float) -> Trials:
    """Return a world in which the factor `best` earns 10, and other factors less in proportion to their distance."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        (mutation,) = candidate.mutations
        found = factor(mutation) or 0.0
        total = 10.0 - (log(found / best) / width) ** 2 if found else 0.0
        return Outcome(total, total > 8.9)

    return Trials(run, 100)


@settings(max_examples=40)
@given(st.floats(0.3, 3.0), st.floats(0.85, 1.18), st.sampled_from([LITERAL, NAMED]))
def test_value_moves_towards_the_middle_of_good_values(best: float, off: float, constant: object) -> None:
    trials = world(best, 0.3)
    mutation = mutations(constant, best * off)  # type: ignore[arg-type]
    assume(mutation is not None)  # a factor of 1 changes nothing
    assert mutation is not None
    found = Candidate((mutation,), ALWAYS)
    before = trials(found, 0).total
    moved = centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows)
    after = trials(moved, 0).total
    assert after >= before
    if before >= 9.0:
        assert after >= 10.0 - THIN * REFERENCE.margin
    if before >= 10.0 - THIN * REFERENCE.margin:
        assert moved == found
        assert trials.spent <= SEEDS


def test_smaller_steps_are_skipped_after_ineffective_ones() -> None:
    trials = Trials(lambda _, __: Outcome(9.0, True), 100)
    found = Candidate((Mutation(LITERAL, 4.4),), ALWAYS)
    assert centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) == found
    assert trials.spent == SEEDS + 2 * BEHIND


def test_values_are_compared_on_known_seeds() -> None:
    trials = world(2.0, 0.3)
    goal = replace(GOAL, pairs=tuple(Pair(seed, 0.0) for seed in range(9)))
    found = Candidate((Mutation(LITERAL, 4.0),), ALWAYS)
    for seed in range(3, 8):
        trials(found, seed)
    assert centred(found, trials, mutations, goal, REFERENCE, Ledger().knows) == found
    assert trials.spent == SEEDS


def test_value_does_not_move_to_a_failing_value() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        found = factor(candidate.mutations[0]) or 0.0
        return Outcome(8.0 + found / 2.0, passed=found < 2.9)

    trials = Trials(run, 100)
    found = Candidate((Mutation(LITERAL, 4.4),), ALWAYS)
    moved_to = centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows)
    reached = factor(moved_to.mutations[0])
    assert reached is not None
    assert 2.2 < reached < 2.9


def test_value_does_not_move_to_one_that_loses_missions() -> None:
    trials = world(4.0, 0.5)
    found = Candidate((Mutation(LITERAL, 5.0),), ALWAYS)
    assert centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) != found
    trials.loses = lambda one: one != found
    assert centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) == found


def test_climb_ends_at_a_value_that_was_examined() -> None:
    def rising(candidate: Candidate, _: int) -> Outcome:
        return Outcome(9.0 + 0.1 * (factor(candidate.mutations[0]) or 0.0), passed=True)

    found = Candidate((Mutation(LITERAL, 4.4),), ALWAYS)
    free, stopped = Trials(rising, 100), Trials(rising, 100)
    centred(found, free, mutations, GOAL, REFERENCE, Ledger().knows)
    before: list[Candidate] = []

    def examined(one: Candidate) -> bool:
        before.append(one)
        return len(before) == 2

    best = centred(found, stopped, mutations, GOAL, REFERENCE, examined)
    assert best == before[1] != found
    assert stopped.spent < free.spent


def test_candidate_that_fails_on_a_known_seed_stays() -> None:
    trials = world(4.0, 0.1)
    found = Candidate((Mutation(LITERAL, 2.2),), ALWAYS)
    assert centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) == found
    assert trials.spent == 1


@pytest.mark.parametrize("value", [-2.0, True])
def test_signs_and_booleans_have_no_neighbours(value: float) -> None:
    constant = operand(5, "False", False) if value is True else LITERAL
    found = Candidate((Mutation(constant, value),), ALWAYS)
    trials = Trials(lambda _, __: Outcome(9.4, passed=True), 100)
    assert centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) == found
    assert trials.spent == SEEDS


def powered(power: float, usual: float) -> Candidate:
    """Return a candidate that scales a constant by a power of a sensor, given factors of its two parameters."""
    made = template(SHIPPED / "power.toml")
    power_of = operand(6, "gap * gain, power", -1.0)
    both = power_of, replace(operand(6, "gap * gain, usual", 4.0), site=power_of.site)
    defaults = (("power", -1.0), ("usual", 4.0))
    values = zip(("power", "usual"), both, (power, usual), strict=True)
    return Candidate(
        tuple(Mutation(one, value, form=Form(made, name, defaults)) for name, one, value in values), ALWAYS
    )


def test_template_exponent_stays_on_its_grid() -> None:
    moved_to = moved(powered(-1.0, 0.9), 1.3, mutations)
    assert moved_to is not None
    assert [one.value for one in moved_to.mutations] == [-1.0, pytest.approx(1.17)]
    alone = Candidate(powered(2.0, 1.0).mutations[:1], ALWAYS)
    assert moved(alone, 1.3, mutations) is None
    assert stronger(alone, 1.5, mutations) is None


def test_a_value_stays_one_step_away_from_failing_values() -> None:
    """The reward grows towards the old value, up to a cliff at a factor of 2.8."""

    def run(candidate: Candidate, _: int) -> Outcome:
        found = factor(candidate.mutations[0]) or 1.0
        return Outcome(10.0 - 0.07 * found, True) if found >= 2.8 else Outcome(0.0, False)

    mutation = mutations(NAMED, 4.2)
    assert mutation is not None
    found = centred(
        Candidate((mutation,), ALWAYS), Trials(run, 100), mutations, GOAL, REFERENCE, Ledger().knows
    )
    value = factor(found.mutations[0])
    assert value is not None
    assert 2.8 * 1.03 < value < 4.2


@pytest.mark.parametrize(("designed", "kept"), [(9.5, True), (9.9, False)])
def test_value_is_not_fitted_to_seeds_that_are_hard_as_designed(designed: float, kept: bool) -> None:
    trials = world(2.0, 0.3)
    trials.design = lambda seed: Outcome(designed, True)
    mutation = mutations(LITERAL, 2.5)
    assert mutation is not None
    found = Candidate((mutation,), ALWAYS)  # earns 9.45
    assert (centred(found, trials, mutations, GOAL, REFERENCE, Ledger().knows) == found) is kept
    assert trials.beside == SEEDS
