"""A constant that several statements use is changed at all of its uses together, then at each of them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.repairing.between import common_factor, factor
from pytest_tarl.repairing.centring import moved
from pytest_tarl.repairing.other_values import ratio_of
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials, label
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit, best_effects, units, uses_apart
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import constant

FIRST = constant(3, "AHEAD", 0.65)
SECOND = replace(constant(8, "AHEAD", 0.65), definition=FIRST.definition)
OUTSIDE = replace(constant(20, "AHEAD", 0.65), definition=FIRST.definition)
OTHERS = [constant(line, f"C{line}", 2.0) for line in range(4, 8)]
PAIRS = tuple(Pair(seed, 0.0, 50) for seed in range(8))
GOAL = Goal(PAIRS, near=9.0, enough=9.5, online=0.0, passing=True)


def searched(needed: set[Operand], other: set[Operand]) -> tuple[Sweep, Candidate | None, Trials]:
    """Search a world in which the `needed` uses must be 2.2 times as large, and the `other` ones unchanged."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: factor(one) or 1.0 for one in candidate.mutations}
        right = all(2.0 < by.get(one, 1.0) < 2.4 for one in needed) and not other & by.keys()
        return Outcome(10.0 if right else -1.0 if needed & by.keys() else 0.0, right, steps=50)

    trials = Trials(run, 200)
    sweep = Sweep([FIRST, *OTHERS, SECOND], mutations, (ALWAYS,), trials, GOAL)
    return sweep, next(sweep.candidates(), None), trials


def test_all_uses_change_before_a_single_one() -> None:
    _, found, trials = searched({FIRST, SECOND}, set())
    assert found is not None
    assert {one.operand for one in found.mutations} == {FIRST, SECOND}
    assert trials.labels[0] == label(found)


def test_single_use_changes_if_the_uses_cancel_out() -> None:
    _, found, _ = searched({SECOND}, {FIRST})
    assert found is not None
    assert [one.operand for one in found.mutations] == [SECOND]


def test_uses_are_tried_alone_after_a_partial_success() -> None:
    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand: factor(one) or 1.0 for one in candidate.mutations}
        right = 2.0 < by.get(SECOND, 1.0) < 2.4 and (seed % 2 == 0 or FIRST not in by)
        return Outcome(10.0 if right else 0.0, right, steps=50)

    trials = Trials(run, 200)
    sweep = Sweep([FIRST, *OTHERS, SECOND], mutations, (ALWAYS,), trials, GOAL)
    found = next(sweep.candidates())
    assert [one.operand for one in found.mutations] == [SECOND]
    others = [at for at, label in enumerate(trials.labels) if "C4" in label]
    assert trials.labels.index(label(found)) < others[0]


def test_ineffective_use_gets_no_credit() -> None:
    sweep, found, _ = searched({SECOND}, set())
    assert found is not None
    effects = sweep.effects()
    assert effects[str(SECOND.site)][0].effect == 10.0
    assert effects[str(FIRST.site)][0].effect == 0.0


def test_each_use_gets_the_credit_of_all_uses() -> None:
    whole, first, second = Unit((FIRST, SECOND)), Unit((FIRST,)), Unit((SECOND,))
    found = best_effects([(whole, {2.2: 9.0}), (first, {2.2: 1.0}), (second, {2.2: 2.0})], mutations)
    assert {each.effect for effects in found.values() for each in effects} == {9.0}


def test_use_with_a_small_gain_gets_no_further_credit() -> None:
    whole, first = Unit((FIRST, SECOND)), Unit((FIRST,))
    found = best_effects([(whole, {2.2: 9.0}), (first, {2.2: 1.0})], mutations)
    assert (found[str(FIRST.site)][0].effect, found[str(SECOND.site)][0].effect) == (1.0, 9.0)


def test_uses_outside_the_search_change_together() -> None:
    plain = [*units([FIRST, *OTHERS, SECOND]), Unit((SECOND,), SHARE)]
    united, parts = uses_apart(plain, units([OUTSIDE, constant(30, "ELSEWHERE", 1.0)]))
    whole = Unit((FIRST, SECOND, OUTSIDE))
    assert united == (whole, *(Unit((one,)) for one in OTHERS), Unit((SECOND,), SHARE))
    assert parts == {whole: (Unit((FIRST,)), Unit((SECOND,)))}
    assert uses_apart(plain[:1], []) == ((plain[0],), {})


def test_uses_are_compared_as_one() -> None:
    whole = Unit((FIRST, SECOND))
    one, other = (Candidate(whole.mutations(mutations, by), ALWAYS) for by in (1.5, 1.2))
    assert common_factor(one) == 1.5
    assert ratio_of(one, other) == pytest.approx(1.25)
    further = moved(one, 1.1, mutations)
    assert further is not None
    assert common_factor(further) == pytest.approx(1.65)
    mixed = Candidate(Unit((FIRST, OTHERS[0])).mutations(mutations, 1.5), ALWAYS)
    assert common_factor(mixed) is None
    assert moved(mixed, 1.1, mutations) is None


def test_single_use_runs_on_the_seed_of_all() -> None:
    ran: dict[tuple[str, float], list[int]] = {}

    def run(candidate: Candidate, seed: int) -> Outcome:
        values = {float(one.value) for one in candidate.mutations}
        uses = "+".join(str(one.operand.span.line) for one in candidate.mutations)
        ran.setdefault((uses, max(values)), []).append(seed)
        return Outcome(0.1 * max(values), False, steps=50)

    sweep = Sweep([FIRST, *OTHERS, SECOND], mutations, (ALWAYS,), Trials(run, 300), GOAL)
    assert list(sweep.candidates()) == []
    for by in (2.2, 0.4):
        assert ran["3", by][0] == ran["8", by][0] == ran["3+8", by][0]
    others = {
        uses for uses, value in ran if value not in (2.2, 0.4)
    }  # both uses act alike, so one of them goes on
    assert "8" not in others
