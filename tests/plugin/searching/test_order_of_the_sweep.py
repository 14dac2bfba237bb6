"""The order in which a sweep tries its constants, written out for small worlds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import Mutation, mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.plateau import STEPS
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials, Wanted
from pytest_tarl.searching.suggestions import Suggestions
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import units
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import WET, constant
from tests.plugin.searching.test_search import operand

A, B = constant(3, "A"), constant(4, "B")
LITERAL = replace(operand(5, "3.0", 3.0), site=replace(operand(5, "3.0", 3.0).site, text="y > 3.0"))
ZERO = replace(operand(6, "0.0", 0.0), site=replace(operand(6, "0.0", 0.0).site, text="z > 0.0"))
FLAG = replace(operand(7, "True", True), site=replace(operand(7, "True", True).site, text="f"))
GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.0, enough=10.0, online=0.0)

Changes = Mapping[Operand, float]
World = Callable[[Changes], float]


def dead(_: Changes) -> float:
    return 0.0


def sweeping(
    world: World, operands: Sequence[Operand], budget: int = 500, goal: Goal = GOAL, **given: Any
) -> tuple[Sweep, list[tuple[str, int]]]:
    """Return a search and the list that receives what it runs: `name × factor` with `|` if guarded, and the seed."""
    seen: list[tuple[str, int]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        changes = {one.operand: one.value for one in candidate.mutations}
        words = " ".join(f"{one.code}={value:.4g}" for one, value in changes.items())
        seen.append((words + "|" * bool(candidate.guard.conjuncts), seed))
        total = world(changes)
        return Outcome(total, total >= 9.0)

    guards = given.pop("guards", (ALWAYS,))
    mutate = proposed if given.get("proposed") else mutations
    return Sweep(operands, mutate, guards, Trials(run, budget), goal, **given), seen


def proposed(moved: Operand, factor: float) -> Mutation:
    """Return a proposal with its own value times the factor; unlike a constant, it changes with a factor of 1."""
    return Mutation(moved, round(float(moved.value or 1.0) * factor, 6))


def order(world: World, operands: Sequence[Operand], **given: Any) -> list[tuple[str, int]]:
    """Return all that a search runs until its end."""
    search, seen = sweeping(world, operands, **given)
    list(search.candidates())
    return seen


def tried(world: World, operands: Sequence[Operand], **given: Any) -> list[str]:
    return [words for words, _ in order(world, operands, **given)]


def test_if_no_constant_matters_every_step_is_tried_once() -> None:
    assert order(dead, [A, LITERAL]) == [
        *(("A=2.2", 0), ("A=0.4", 1)),  # named constants first
        *(("3.0=6.6", 1), ("3.0=1.2", 2)),
        *(("A=1.5", 1), ("3.0=4.5", 1), ("A=0.65", 2), ("3.0=1.95", 2)),
        *(("A=10", 0), ("3.0=30", 0), ("A=0.05", 1), ("3.0=0.15", 1)),
        *(("A=5", 1), ("3.0=15", 1), ("A=0.15", 2), ("3.0=0.45", 2)),
        *(("A=-1", 0), ("3.0=-3", 0)),
    ]


def test_each_step_runs_on_the_next_seed() -> None:
    seeds: dict[str, set[int]] = {}
    for words, seed in order(dead, [LITERAL, ZERO, FLAG]):
        seeds.setdefault(words, set()).add(seed)
    assert all(len(found) == 1 for found in seeds.values())
    assert {*seeds["3.0=6.6"], *seeds["0.0=1.2"], *seeds["True=0"]} == {0}
    assert {*seeds["3.0=1.2"], *seeds["0.0=-1.5"]} == {1}


def test_a_boolean_is_flipped_once() -> None:
    assert tried(dead, [FLAG]) == ["True=0"]


def test_effective_constants_get_moderate_steps_first() -> None:
    found = tried(lambda changes: -float(A in changes), [LITERAL, A])
    assert found[:5] == ["A=2.2", "A=0.4", "A=1.5", "A=0.65", "3.0=6.6"]


def test_constant_with_a_small_loss_gets_every_step() -> None:
    found = tried(lambda changes: -0.5 * float(A in changes), [A])
    expected = [f"A={step:.4g}" for step, _ in STEPS]
    assert set(expected) <= set(found)
    assert [one for one in found if one in expected][:8] == [
        *("A=1.5", "A=0.65", "A=5", "A=0.15", "A=1.22", "A=0.82", "A=1.35", "A=0.74"),
    ]


def test_larger_steps_stop_after_a_loss() -> None:
    found = tried(lambda changes: -1.5 if changes.get(A, 1.0) in (2.2, 0.4) else 0.0, [A])
    late = found.index("A=10")
    assert "A=5" not in found[:late]
    assert found[late:] == ["A=10", "A=0.05", "A=5", "A=0.15"]


def test_losing_constants_get_intermediate_and_finer_steps() -> None:
    found = tried(lambda changes: -3.0 * float(LITERAL in changes), [LITERAL])
    assert found[:6] == ["3.0=6.6", "3.0=1.2", "3.0=4.5", "3.0=1.95", "3.0=3.66", "3.0=2.46"]


def test_large_gain_elsewhere_stops_finer_steps() -> None:
    def world(changes: Changes) -> float:
        if LITERAL in changes:
            return -3.0
        return 5.5 if A in changes else 0.0

    found = tried(world, [A, LITERAL])
    combined = next(at for at, words in enumerate(found) if " " in words)
    assert "3.0=3.66" not in found[:combined]
    assert {"3.0=4.5", "3.0=1.95"} <= set(found[:combined])


def test_constant_that_gained_when_reduced_gets_a_negative_sign() -> None:
    found = tried(lambda changes: 2.0 if changes.get(LITERAL, 3.0) < 3.0 else 0.0, [LITERAL, A])
    assert found[found.index("3.0=1.2") + 1] == "3.0=-3"


def test_sign_changes_for_at_most_three_good_constants() -> None:
    many = [constant(line, f"N{line}") for line in range(10, 16)]

    def world(changes: Changes) -> float:
        ((one, factor),) = [*changes.items()][:1]
        return (2.0 if one in many[:5] else 0.9) if factor == 0.4 else 0.0

    search, seen = sweeping(world, many)
    list(islice(search.candidates(), 1))
    first = [words for words, _ in seen if words.endswith("=-1")]
    assert first[:3] == ["N10=-1", "N11=-1", "N12=-1"]
    at = [words for words, _ in seen].index("N12=-1")
    assert not seen[at + 1][0].endswith("=-1")


def test_second_condition_needs_a_first_one() -> None:
    unguarded = tried(dead, [LITERAL], guards=(ALWAYS, WET))
    assert unguarded[:6] == ["3.0=6.6", "3.0=1.2", "3.0=4.5", "3.0=4.5|", "3.0=1.95", "3.0=1.95|"]
    guarded = tried(dead, [LITERAL], guards=(WET, ALWAYS))
    assert guarded[:4] == ["3.0=6.6|", "3.0=1.2|", "3.0=4.5|", "3.0=4.5"]


def test_conditional_gain_is_tried_without_the_condition() -> None:
    search, seen = sweeping(lambda changes: 4.0 if changes.get(LITERAL) == 6.6 else 0.0, [LITERAL, A])
    search.attempts.guards = (WET, ALWAYS)
    list(search.candidates())
    words = [one for one, _ in seen]
    assert 0 < words.index("3.0=6.6") - words.index("3.0=6.6|") < 8


def test_conditional_search_keeps_the_condition() -> None:
    found = tried(lambda changes: 4.0 if changes.get(LITERAL) == 6.6 else 0.0, [LITERAL, A], guards=(WET,))
    assert all(words.endswith("|") for words in found)


def test_constants_outside_flows_come_last() -> None:
    found = tried(dead, [A], late=[LITERAL], aside=[B])
    assert found[:2] == ["A=2.2", "A=0.4"]
    first = {name: next(at for at, one in enumerate(found) if one.startswith(name)) for name in "AB3"}
    assert first["A"] < first["B"] < first["3"]


def test_set_aside_constants_come_before_plateau_steps() -> None:
    found = tried(lambda changes: -0.5 * float(A in changes), [A], aside=[B])
    assert found.index("A=5") < found.index("B=2.2") < found.index("A=1.22")


def test_last_steps_are_reserved_for_structures() -> None:
    found = tried(lambda changes: -3.0 * float(A in changes), [A, LITERAL], structure_follows=True)
    assert "A=10" not in found
    assert "3.0=30" not in found
    assert "A=10" in tried(lambda changes: -3.0 * float(A in changes), [A, LITERAL])


def test_a_proposal_is_first_tried_with_its_own_value() -> None:
    assert tried(lambda _: -0.5, [LITERAL], proposed=True)[:4] == ["3.0=3", "3.0=-3", "3.0=6.6", "3.0=1.2"]


def test_weak_proposal_is_strengthened_at_responding_constants() -> None:
    stays = tried(dead, [LITERAL], proposed=True, responding=[str(LITERAL.site)])
    assert stays[:5] == ["3.0=3", "3.0=6.6", "3.0=1.2", "3.0=15", "3.0=0.45"]
    assert "3.0=15" not in tried(dead, [LITERAL], proposed=True)[:5]


def test_weakening_factor_is_skipped() -> None:
    found = tried(dead, [LITERAL], proposed=True, weaker=lambda _, factor: factor < 1.0)
    assert found[:2] == ["3.0=3", "3.0=6.6"]
    assert not [one for one in found if one in ("3.0=1.2", "3.0=0.45", "3.0=1.95", "3.0=0.15", "3.0=-3")]


def test_a_proposal_with_an_effect_is_not_skipped() -> None:
    found = tried(lambda _: -0.5, [LITERAL], proposed=True, weaker=lambda _, factor: factor < 1.0)
    assert "3.0=1.2" in found


@pytest.mark.parametrize(("reward", "finer"), [(-1.1, False), (-0.9, True)])
def test_losing_proposal_gets_no_finer_steps(reward: float, finer: bool) -> None:
    found = tried(lambda _: reward, [LITERAL], proposed=True)
    assert {"3.0=4.5", "3.0=1.95"} <= {*found}
    assert ({"3.0=3.66", "3.0=2.46", "3.0=3.3", "3.0=2.73"} & {*found} != set()) is finer


def test_unwritable_constant_is_skipped() -> None:
    def world(changes: Changes) -> float:
        if A in changes:
            raise RepairError("no place")
        return 0.0

    found = tried(world, [A, LITERAL])
    assert found[:3] == ["A=2.2", "A=0.4", "3.0=6.6"]
    assert found.count("A=2.2") == 1


def test_interlude_gets_the_largest_gain_before_each_step() -> None:
    heard: list[float] = []

    def interlude(gain: float) -> Iterator[Candidate]:
        heard.append(gain)
        return iter(())

    search, _ = sweeping(
        lambda changes: 4.0 if changes.get(LITERAL) == 6.6 else 0.0,
        [LITERAL],
        suggestions=Suggestions(interlude=interlude),
    )
    list(search.candidates())
    assert heard[:2] == [0.0, 4.0]
    assert set(heard) == {0.0, 4.0}


def test_the_interlude_may_yield_candidates_of_another_search() -> None:
    other = Candidate((), WET)
    search, seen = sweeping(dead, [LITERAL], suggestions=Suggestions(interlude=lambda _: iter([other])))
    assert next(search.candidates()) == other
    assert seen == []


def test_confirmed_candidate_is_yielded_once() -> None:
    search, seen = sweeping(lambda changes: 10.0 if changes.get(LITERAL) == 6.6 else 0.0, [LITERAL])
    found = list(search.candidates())
    assert [one.mutations[0].value for one in found] == [6.6]
    assert seen[:4] == [("3.0=6.6", 0), ("3.0=6.6", 1), ("3.0=6.6", 2), ("3.0=6.6", 3)]


def test_yielded_change_counts_as_refused_afterwards() -> None:
    search, _ = sweeping(lambda changes: 10.0 if changes.get(LITERAL) == 6.6 else 0.0, [LITERAL])
    (unit,) = units([LITERAL])
    found = search.attempts.attempt(unit, ALWAYS, 2.2, 0)
    assert next(found).mutations[0].value == 6.6
    assert search.attempts.refused == set()
    assert list(found) == []
    assert search.attempts.refused == {(unit, ALWAYS)}


def test_change_with_known_losses_counts_as_refused() -> None:
    search, _ = sweeping(lambda changes: 10.0, [LITERAL])
    search.attempts.trials.loses = lambda _: True
    (unit,) = units([LITERAL])
    assert list(search.attempts.attempt(unit, ALWAYS, 2.2, 0)) == []
    assert search.attempts.refused == {(unit, ALWAYS)}


def announced(operands: Sequence[Operand]) -> list[list[tuple[float, int]]]:
    """Return what a sweep announces in a dead world, as values and seeds."""
    search, _ = sweeping(dead, operands)
    heard: list[list[tuple[float, int]]] = []

    def foresee(wanted: Sequence[Wanted]) -> None:
        heard.append([(one.mutations[0].value, seed) for one, seed in wanted])

    search.attempts.trials.foresee = foresee
    list(search.candidates())
    return heard


def test_remaining_runs_of_a_step_are_announced() -> None:
    heard = announced([LITERAL, ZERO])
    assert heard[:2] == [[(6.6, 0), (1.2, 0)], [(1.2, 0)]]
    assert heard[2:4] == [[(pytest.approx(1.2), 1), (-1.5, 1)], [(-1.5, 1)]]


def test_tried_changes_are_not_announced() -> None:
    heard = announced([FLAG, LITERAL])
    assert [len(one) for one in heard[:2]] == [2, 1]
    assert all(value != 0 for step in heard[2:] for value, _ in step)


def test_zero_with_a_scale_has_no_other_steps() -> None:
    found = tried(dead, [ZERO], charts={ZERO: SHARE})
    assert len(found) == len(set(found))
    assert all(-1.0 <= float(one.partition("=")[2]) <= 1.0 for one in found)


def test_statement_effect_is_its_best_factor() -> None:
    search, _ = sweeping(lambda changes: 3.0 if changes.get(LITERAL) == 6.6 else 0.0, [LITERAL, A])
    list(search.candidates())
    effects = search.effects()
    (literal,) = effects[str(LITERAL.site)]
    assert (literal.code, literal.value, literal.best, literal.effect) == ("3.0", 3.0, 6.6, 3.0)
    (name,) = effects[str(A.site)]
    assert name.effect == 0.0


def test_change_stays_open_while_it_may_be_confirmed() -> None:
    search, seen = sweeping(lambda changes: 10.0, [LITERAL])
    (unit,) = units([LITERAL])
    assert search.attempts.reaches(unit, 2.2, ALWAYS, 1, confirmable=False)
    assert search.attempts.holding(unit, 2.2, ALWAYS, 1) is None
    assert search.attempts.reaches(unit, 3.0, ALWAYS, 1)
    assert search.attempts.holding(unit, 3.0, ALWAYS, 1) is not None
    assert not search.attempts.reaches(unit, 3.0, ALWAYS, 1)
    assert seen[:2] == [("3.0=6.6", 1), ("3.0=9", 1)]


def test_failed_change_is_not_tried_again() -> None:
    search, seen = sweeping(lambda changes: 4.0, [LITERAL])
    (unit,) = units([LITERAL])
    assert not search.attempts.reaches(unit, 2.2, ALWAYS, 1)
    assert search.attempts.holding(unit, 2.2, ALWAYS, 1) is None
    assert search.attempts.holding(unit, 1.5, ALWAYS, 2) is None
    assert seen == [("3.0=6.6", 1), ("3.0=4.5", 2)]
    assert search.attempts.gains.of(unit, ALWAYS) == {1.0: 0.0, 2.2: 4.0, 1.5: 4.0}


def test_ineffective_change_is_never_confirmed() -> None:
    search, seen = sweeping(lambda changes: 10.0, [LITERAL])
    (unit,) = units([LITERAL])
    assert not search.attempts.reaches(unit, 1.0, ALWAYS, 0)
    assert search.attempts.holding(unit, 1.0, ALWAYS, 0) is None
    assert list(search.attempts.attempt(unit, ALWAYS, 1.0, 0)) == []
    assert seen == []


def test_unwritable_change_is_never_confirmed() -> None:
    def world(_: Changes) -> float:
        raise RepairError("no place")

    search, _ = sweeping(world, [LITERAL])
    (unit,) = units([LITERAL])
    assert not search.attempts.reaches(unit, 2.2, ALWAYS, 0)
    assert search.attempts.holding(unit, 1.5, ALWAYS, 0) is None
    assert list(search.attempts.attempt(unit, ALWAYS, 3.0, 0)) == []
    assert search.attempts.gains.of(unit, ALWAYS) == {}
