"""The steps of forward selection, screening and ranking, run by run in scripted worlds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil, inf, sqrt
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Designed, Outcome, Reference, World
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint, Settled
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.halving import Halving, arm_effects
from pytest_tarl.searching.race import Arm, Race
from pytest_tarl.searching.ranking import FLIP, Ranking
from pytest_tarl.searching.screening import RUNS, screened
from pytest_tarl.searching.search import FACTORS, BudgetSpentError, Candidate, Goal, Pair, Trials
from pytest_tarl.searching.sweep import Sweep
from pytest_tarl.searching.units import Unit
from tarl_lint.model import Operand
from tests.plugin.searching.test_gains import WET, constant

A, B, C, D, E, F, G = (Unit((constant(line, name),)) for line, name in enumerate("ABCDEFG", 2))
GOAL = Goal(tuple(Pair(seed, 0.0) for seed in range(4)), near=9.0, enough=10.0, online=0.0)

Changes = Mapping[Operand, float]


def selection(
    world: Callable[[dict[str, float], int], float],
    units: Sequence[Unit] = (A, B, C),
    gains: Mapping[Unit, Mapping[float, float]] | None = None,
    **given: Any,
) -> tuple[ForwardSelection, list[tuple[str, int]]]:
    """Return a selection and the list of what it runs; `world` gets factors by name, and the seed."""
    seen: list[tuple[str, int]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        by = {one.operand.code: float(one.value) for one in candidate.mutations}
        seen.append((" ".join(f"{name}{value:.4g}" for name, value in by.items()), seed))
        total = world(by, seed)
        return Outcome(total, total >= 9.0)

    goal = given.pop("goal", GOAL)
    return ForwardSelection(units, mutations, Trials(run, 900), goal, gains or {}, 1.0, **given), seen


def first(seen: Sequence[tuple[str, int]]) -> list[str]:
    """Return what ran on the first seed."""
    return [words for words, seed in seen if seed == 0]


def joint(*parts: tuple[Unit, float]) -> Joint:
    return Joint(parts, ALWAYS)


def refused(by: dict[str, float]) -> RepairError:
    return RepairError(f"no place for {by}")


# single steps


def test_gain_is_the_mean_over_executed_seeds() -> None:
    search, seen = selection(lambda by, seed: 3.0 + seed)
    search.trials(joint((A, 2.2)).candidate(mutations), 2)
    found = search.gain(joint((A, 2.2)))
    with pytest.raises(StopIteration) as end:
        next(found)
    assert end.value.value == 4.0
    assert seen == [("A2.2", 2), ("A2.2", 0)]

    def impossible(by: dict[str, float], seed: int) -> float:
        raise refused(by)

    other, _ = selection(impossible)
    with pytest.raises(StopIteration) as end:
        next(other.gain(joint((A, 2.2))))
    assert end.value.value is None


def test_better_near_factor_is_added_first() -> None:
    gains = {B: {2.2: -1.0, 0.4: 2.0}, C: {2.2: 1.0}}
    search, _ = selection(lambda by, seed: 0.0, gains=gains)
    found = [one.parts[1] for turn in (0, 1) for one in search._with_another(joint((A, 2.2)), turn)]
    assert found == [(B, 0.4), (C, 2.2), (B, 2.2), (C, 0.4)]


@pytest.mark.parametrize(
    ("slack", "passing", "first"), [(1.0, True, 2.2), (0.01, True, 0.4), (1.0, False, 0.4)]
)
def test_factor_with_longer_missions_is_added_first(slack: float, passing: bool, first: float) -> None:
    def run(candidate: Candidate, _: int) -> Outcome:
        increased = candidate.mutations[0].value == 2.2
        return Outcome(-0.1 if increased else 0.0, False, steps=20 if increased else 8)

    goal = replace(GOAL, pairs=tuple(Pair(seed, 0.0, 10) for seed in range(4)), passing=passing)
    gains = {B: {2.2: -0.1, 0.4: 0.0}}
    search = ForwardSelection((A, B), mutations, Trials(run, 90), goal, gains, slack)
    for factor in (2.2, 0.4):
        search.trials(joint((B, factor)).candidate(mutations), 0)
    (wider,) = search._with_another(joint((A, 0.4)), 0)
    assert wider.parts[1] == (B, first)


def test_parts_are_adjusted_one_by_one() -> None:
    def world(by: dict[str, float], _: int) -> float:
        return 8.0 - abs(by["A"] - 3.3) - abs(by["B"] - 0.26)

    search, seen = selection(world)
    found = search._balanced(joint((A, 2.2), (B, 0.4)), 8.0 - 1.1 - 0.14)
    with pytest.raises(StopIteration) as end:
        next(found)
    base, gain = end.value.value
    assert dict(base.parts) == {A: 3.3, B: 0.26}
    assert gain == pytest.approx(8.0)
    assert first(seen) == [
        "B0.4 A3.3",
        "A3.3 B0.6",
        "A3.3 B0.26",
    ]


def test_a_fixed_parameter_climbs_while_the_gain_increases() -> None:
    search, seen = selection(lambda by, _: 2.0 + 2.0 * min(by.get("B", 1.0), 1.2))
    list(search.climbed(joint((A, 2.2)), B))
    assert first(seen) == ["A2.2", "A2.2 B0.9", "A2.2 B1.1", "A2.2 B1.21", "A2.2 B1.331"]


def test_falling_fixed_parameter_is_not_raised() -> None:
    search, seen = selection(lambda by, _: 5.0 - by.get("B", 1.0))
    list(search.climbed(joint((A, 2.2)), B))
    assert first(seen) == ["A2.2", "A2.2 B0.9", "A2.2 B0.81", "A2.2 B0.729", "A2.2 B0.656"]


def test_no_fixed_parameter_climbs_if_the_base_cannot_run() -> None:
    def world(by: dict[str, float], _: int) -> float:
        raise refused(by)

    search, seen = selection(world)
    assert list(search.climbed(joint((A, 2.2)), B)) == []
    assert first(seen) == ["A2.2"]


# the fewest parts


def needs(*names: str) -> Callable[[dict[str, float], int], float]:
    return lambda by, seed: 10.0 if set(names) <= by.keys() else 0.0


def test_only_needed_parts_are_kept() -> None:
    search, _ = selection(needs("B"))
    (found,) = search.fewest(joint((A, 1.5), (B, 1.5), (C, 1.5)))
    assert [one.operand.code for one in found.mutations] == ["B"]
    assert search.settled.held == {found}


def test_more_than_three_needed_parts_are_too_many() -> None:
    search, _ = selection(needs("A", "B", "C", "D"))
    assert list(search.fewest(joint(*[(one, 1.5) for one in (A, B, C, D)]))) == []
    search, _ = selection(needs("A", "B", "C"))
    assert len(list(search.fewest(joint(*[(one, 1.5) for one in (A, B, C, D)])))) == 1


def test_insufficient_parts_are_all_kept() -> None:
    search, seen = selection(lambda by, seed: 0.0)
    assert list(search.fewest(joint((A, 1.5), (B, 1.5)))) == []
    assert first(seen) == ["A1.5 B1.5"]

    def impossible(by: dict[str, float], _: int) -> float:
        raise refused(by)

    other, _ = selection(impossible)
    assert list(other.fewest(joint((A, 1.5)))) == []


def test_a_confirmed_candidate_is_settled_and_not_tried_again() -> None:
    settled, search = Settled(), selection(needs("A"))[0]
    candidate = joint((A, 1.5)).candidate(mutations)
    assert settled.holds(candidate, search.trials, GOAL, 0)
    assert settled.held == settled.tried == {candidate}
    assert not settled.holds(candidate, search.trials, GOAL, 0)
    failing = joint((B, 1.5)).candidate(mutations)
    assert not settled.holds(failing, search.trials, GOAL, 0)
    assert settled.held == {candidate}
    assert failing in settled.tried


def test_combination_with_a_known_part_is_not_yielded() -> None:
    search, _ = selection(needs("A"))
    (alone,) = search.gain(joint((A, 1.5)))
    assert list(search.gain(joint((A, 1.5), (B, 1.5)))) == []
    assert joint((A, 1.5), (B, 1.5)).candidate(mutations) in search.settled.tried
    assert search.settled.held == {alone}


def test_preferred_change_comes_before_a_single_part() -> None:
    other = joint((C, 0.4)).candidate(mutations)
    asked: list[Any] = []

    def preferred(candidate: Candidate, unit: Unit, factor: float) -> Iterator[Candidate]:
        asked.append((unit, factor))
        yield other

    search, _ = selection(needs("A"), preferred=preferred)
    found = list(search.gain(joint((A, 1.5), (B, 1.5))))
    assert found == [other, joint((A, 1.5)).candidate(mutations)]
    assert asked == [(A, 1.5)]
    pair, _ = selection(needs("A", "B"), preferred=preferred)
    assert list(pair.gain(joint((A, 1.5), (B, 1.5)))) == [joint((A, 1.5), (B, 1.5)).candidate(mutations)]
    assert asked == [(A, 1.5)]


# combinations


def test_combination_grows_while_parts_gain() -> None:
    def world(by: dict[str, float], _: int) -> float:
        return 2.0 * ("A" in by) + 2.0 * (by.get("B") == 0.4) + 0.9 * ("C" in by)

    search, seen = selection(world)
    assert list(search.candidates(joint((A, 2.2)))) == []
    tried = first(seen)
    assert tried[:5] == ["A2.2", "A2.2 B2.2", "A2.2 C2.2", "A2.2 B0.4", "A2.2 C0.4"]
    assert "B0.4 A3.3" in tried  # the better pair is balanced
    assert any(len(words.split()) == 3 for words in tried)
    assert not any(len(words.split()) > 3 for words in tried)


def test_confirmed_combination_is_not_extended() -> None:
    search, seen = selection(needs("A"))
    (found,) = search.candidates(joint((A, 2.2)))
    assert found == joint((A, 2.2)).candidate(mutations)
    assert first(seen) == ["A2.2"]

    def impossible(by: dict[str, float], _: int) -> float:
        raise refused(by)

    other, seen = selection(impossible)
    assert list(other.candidates(joint((A, 2.2)))) == []
    assert len(seen) == 1


def test_first_part_is_combined_with_the_next_five() -> None:
    def world(by: dict[str, float], _: int) -> float:
        return 1.0 * ("A" in by) + 2.0 * ("C" in by) + 1.5 * ("E" in by)

    search, seen = selection(world)
    parts = [(one, 2.2) for one in (A, B, C, D, E, F, G)]
    list(search.unions(parts, ALWAYS))
    pairs = [words for words in first(seen) if len(words.split()) == 2]
    assert pairs[:5] == ["A2.2 B2.2", "A2.2 C2.2", "A2.2 D2.2", "A2.2 E2.2", "A2.2 F2.2"]
    triples = [words for words in first(seen) if len(words.split()) == 3]
    assert triples[:4] == ["A2.2 C2.2 B2.2", "A2.2 C2.2 D2.2", "A2.2 C2.2 E2.2", "A2.2 C2.2 F2.2"]
    assert len(triples) == 4  # 4.5 of 10 is not promising, so the best one is not balanced


def test_promising_combination_is_balanced_and_extended() -> None:
    def world(by: dict[str, float], _: int) -> float:
        return 3.0 * ("A" in by) + 3.0 * ("B" in by) + 2.0 * (by.get("D", 0) == 5.0 and len(by) == 3)

    search, seen = selection(world)
    list(search.unions([(A, 2.2), (B, 2.2)], ALWAYS, [C, D]))
    tried = first(seen)
    assert tried[:2] == ["A2.2 B2.2", "B2.2 A3.3"]
    assert "A2.2 B2.2 C5" in tried
    assert "A2.2 B2.2 D5" in tried
    assert any("D7.5" in words for words in tried)  # 8 exceeds 6 by more than the slack, so it is balanced


def test_ineffective_constants_join_the_best_combination() -> None:
    def world(by: dict[str, float], _: int) -> float:
        return 2.0 * len(by.keys() & {"A", "B", "C"})

    search, seen = selection(world)
    list(search.unions([(A, 2.2), (B, 2.2), (C, 2.2)], ALWAYS, [D]))
    assert [words for words in first(seen) if "D" in words] == []  # 4 of 10 is not promising for a pair
    richer, seen = selection(lambda by, _: 2.9 * len(by.keys() & {"A", "B", "C"}))
    list(richer.unions([(A, 2.2), (B, 2.2), (C, 2.2)], ALWAYS, [D]))
    assert [words for words in first(seen) if "D" in words] == ["A2.2 B2.2 D5"]


def test_pair_that_cannot_run_is_not_extended() -> None:
    def world(by: dict[str, float], _: int) -> float:
        raise refused(by)

    search, seen = selection(world, goal=replace(GOAL, near=0.5, enough=1.0))
    assert list(search._with_what_was_hidden(joint((A, 2.2), (B, 2.2)), [C])) == []
    assert first(seen) == ["A2.2 B2.2"]


def test_sufficient_pair_gets_no_third_part() -> None:
    search, seen = selection(lambda by, seed: (30.0 if seed == 0 else 5.0) if len(by) > 1 else 0.0)
    list(search.unions([(A, 2.2), (B, 2.2), (C, 2.2)], ALWAYS))
    assert not any(len(words.split()) > 2 for words in first(seen))


def test_confirmed_part_is_not_combined() -> None:
    search, seen = selection(needs("A"))
    list(search.gain(joint((A, 2.2))))
    before = len(seen)
    assert list(search.unions([(A, 2.2), (B, 2.2)], ALWAYS)) == []
    assert len(seen) == before


# single constants on hard seeds


def test_single_constant_is_adjusted_after_three_seeds() -> None:
    for total, seeds, adjusted in ((7.0, 3, True), (6.9, 3, False), (7.0, 2, False)):
        search, seen = selection(lambda by, seed, total=total: total)  # type: ignore[misc]
        for seed in range(seeds):
            search.trials(joint((A, 2.2)).candidate(mutations), seed)
        assert list(search.sharpened(A, 2.2, ALWAYS)) == []
        assert (len(seen) > seeds) is adjusted


def test_an_unchanged_factor_is_not_confirmed() -> None:
    search, _ = selection(lambda by, seed: 9.5 if by["A"] == 2.2 else 0.0, goal=replace(GOAL, enough=9.0))
    for seed in range(3):
        search.trials(joint((A, 2.2)).candidate(mutations), seed)
    assert list(search.sharpened(A, 2.2, ALWAYS)) == []
    assert search.settled.tried == set()


# uses


def test_search_learns_from_each_confirmed_use() -> None:
    one, two = constant(3, "AHEAD"), replace(constant(8, "AHEAD"), definition=constant(3, "AHEAD").definition)
    seen: list[int] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        seen.append(len(candidate.mutations))
        return Outcome(10.0, True)

    sweep = Sweep([one, two], mutations, (ALWAYS,), Trials(run, 100), GOAL)
    (whole,) = sweep.attempts.units
    assert sweep.attempts.holding(whole, 2.2, ALWAYS, 0) is not None
    assert seen == [2, 2, 2, 2, 1, 1]
    assert set(sweep.attempts.gains.under(ALWAYS)) == {whole, Unit((one,)), Unit((two,))}


# screening


def many(count: int) -> list[Unit]:
    return [Unit((constant(line, f"N{line}"),)) for line in range(100, 100 + count)]


@pytest.mark.parametrize("count", [5, 41])
def test_screening_runs_grow_with_the_square_root(
    count: int,
) -> None:
    search, seen = selection(lambda by, seed: 0.0, many(count))
    found = list(screened(search, ALWAYS, np.random.default_rng(0)))
    assert found == []
    assert len(seen) == len(set(seen)) == ceil(RUNS * sqrt(count))
    assert {len(words.split()) for words in first(seen)} == {4}


def test_screening_lists_the_gaining_constant_first() -> None:
    units = many(10)
    search, _ = selection(lambda by, seed: 5.0 if by.get("N107") == 0.4 else 0.0, units)
    order = yield_from(screened(search, ALWAYS, np.random.default_rng(1)))
    assert order[0] == units[7]
    assert set(order) == set(units)


def test_a_screening_in_which_nothing_runs_keeps_the_order() -> None:
    def world(by: dict[str, float], seed: int) -> float:
        raise refused(by)

    units = many(6)
    search, _ = selection(world, units)
    assert yield_from(screened(search, ALWAYS, np.random.default_rng(1))) == tuple(units)


def yield_from(generator: Any) -> Any:
    """Return the result of a generator that yields nothing."""
    with pytest.raises(StopIteration) as end:
        next(generator)
    return end.value.value


# races, halving and ranking


def racing(
    world: Callable[[str, float, int], float], count: int = 8
) -> tuple[Race, list[tuple[str, float, int]]]:
    seen: list[tuple[str, float, int]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (one,) = candidate.mutations
        seen.append((one.operand.code, float(one.value), seed))
        return Outcome(world(*seen[-1]), False)

    pairs = tuple(Pair(seed, float(seed)) for seed in range(count))
    goal = Goal(pairs, near=inf, enough=inf, online=0.0)
    return Race(mutations, Trials(run, 900), goal), seen


def test_gain_is_relative_to_the_unmutated_run() -> None:
    race, seen = racing(lambda name, factor, seed: seed + factor)
    arms = [Arm(A, 2.2, ALWAYS), Arm(B, 0.4, ALWAYS), Arm(C, 1.0, ALWAYS)]
    race.run(arms, 2)
    assert seen == [("A", 2.2, 0), ("B", 0.4, 0), ("A", 2.2, 1), ("B", 0.4, 1)]
    assert race.gains[arms[0]] == {0: pytest.approx(2.2), 1: pytest.approx(2.2)}
    assert (race.gain(arms[2]), race.ranked(arms)) == (0.0, arms[:2])
    race.run(arms[:1], 3)
    assert seen[4:] == [("A", 2.2, 2)]


def test_unwritable_ranked_change_has_no_gain() -> None:
    def world(name: str, factor: float, seed: int) -> float:
        if name == "A":
            raise RepairError("no place")
        return 1.0

    race, _ = racing(world)
    race.run([Arm(A, 2.2, ALWAYS), Arm(B, 2.2, ALWAYS)], 1)
    assert list(race.gains) == [Arm(B, 2.2, ALWAYS)]


def test_new_factors_lie_halfway_to_neighbours() -> None:
    race, _ = racing(lambda name, factor, seed: 0.0)
    for unit, factor, guard in (
        (A, 0.4, ALWAYS),
        (A, 2.2, ALWAYS),
        (A, 2.4, ALWAYS),
        (A, 9.0, ALWAYS),
        (A, 3.0, WET),
        (A, -1.0, ALWAYS),
        (B, 2.3, ALWAYS),
    ):
        race.gains[Arm(unit, factor, guard)] = {0: 0.0}
    around = race.around(Arm(A, 2.2, ALWAYS))
    assert [one.factor for one in around] == [round(sqrt(0.4 * 2.2), 3)]  # 2.4 is too near
    assert [one.factor for one in race.around(Arm(A, 2.4, ALWAYS))] == [round(sqrt(2.4 * 9.0), 3)]
    assert race.around(Arm(A, -1.0, ALWAYS)) == []
    assert race.around(Arm(A, 5.0, ALWAYS)) == []
    race.gains[Arm(A, 0.0, ALWAYS)] = {0: 0.0}
    assert [one.factor for one in race.around(Arm(A, 0.4, ALWAYS))] == [round(sqrt(0.4 * 2.2), 3)]


def test_constant_effect_is_that_of_its_best_change() -> None:
    race, _ = racing(lambda name, factor, seed: seed + (factor if name == "A" else -1.0))
    race.run([Arm(A, 2.2, ALWAYS), Arm(A, 5.0, ALWAYS), Arm(A, 0.4, ALWAYS), Arm(B, 2.2, ALWAYS)], 1)
    effects = arm_effects(race)
    (one,) = effects[str(A.operands[0].site)]
    assert (one.best, one.effect) == (10.0, 5.0)
    (two,) = effects[str(B.operands[0].site)]
    assert two.effect == -1.0


def test_halving_keeps_the_better_half() -> None:
    seen: list[tuple[str, float, int]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (one,) = candidate.mutations[:1]
        seen.append((one.operand.code, float(one.value), seed))
        return Outcome(3.0 if (one.operand.code, one.value) == ("A", 5.0) else 0.0, False)

    search = Halving([A.operands[0], B.operands[0]], mutations, (ALWAYS,), Trials(run, 900), GOAL)
    assert list(search.candidates()) == []
    assert [(name, factor) for name, factor, seed in seen[: 2 * len(FACTORS)]] == [
        (name, factor) for factor in FACTORS for name in "AB"
    ]
    later = [(name, factor) for name, factor, seed in seen if seed == 1]
    assert later[:3] == [("A", 5.0), ("A", round(sqrt(2.2 * 5.0), 3)), ("A", round(sqrt(50.0), 3))]


def test_ranking_refines_only_important_constants() -> None:
    seen: list[tuple[str, float, int]] = []

    def run(candidate: Candidate, seed: int) -> Outcome:
        (one,) = candidate.mutations
        seen.append((one.operand.code, float(one.value), seed))
        return Outcome(3.0 if (one.operand.code, one.value) == ("A", 2.2) else 0.0, False)

    ranking = Ranking([A.operands[0], B.operands[0]], mutations, ALWAYS, Trials(run, 900), GOAL)
    ranking.run()
    assert ranking.whole
    assert [(name, factor) for name, factor, seed in seen if name == "B"] == [("B", 2.2), ("B", 0.4)]
    tried = [factor for name, factor, seed in seen if name == "A" and seed == 0]
    assert tried[:8] == [*FACTORS, FLIP]
    assert {seed for name, factor, seed in seen if (name, factor) == ("A", 2.2)} == {0, 1, 2, 3}
    assert ranking.certainty("nowhere") is None


def test_a_ranking_that_runs_out_of_episodes_is_incomplete() -> None:
    ranking = Ranking([A.operands[0]], mutations, ALWAYS, Trials(lambda *_: Outcome(0.0, False), 1), GOAL)
    ranking.run()
    assert not ranking.whole


# gains


def table(*tries: tuple[Unit, float, float], slack: float = 1.0, **given: Any) -> Gains:
    found = Gains(slack, **given)
    for unit, factor, gain in tries:
        found.enter((unit, ALWAYS), factor, gain)
    return found


def test_best_conditional_constants_are_sorted_by_gain() -> None:
    found = table((A, 5.0, 2.0), (B, 0.4, 9.0), (C, 2.2, -1.0), (D, 1.5, 4.0))
    assert found.best_under([ALWAYS]) == [(B, 0.4), (D, 1.5), (A, 5.0)]
    assert found.best_under([WET]) == []


def test_best_statement_changes_are_sorted_by_gain() -> None:
    found = table((A, 5.0, 2.0), (A, 0.4, 3.0), (B, 2.2, 9.0), (C, 2.2, 0.0))
    assert found.leaders(ALWAYS) == [(9.0, (B, 2.2)), (3.0, (A, 0.4))]


def test_constants_are_ordered_by_their_previous_gain() -> None:
    found = table((A, 2.2, -0.5), (B, 2.2, 3.0), (C, 2.2, 1.0), (D, 0.4, 9.0))
    assert found.leading(2.2, ALWAYS, [A, B, C, D], -1.0) == [B, C, A]
    assert found.leading(2.2, ALWAYS, [A, B, C, D], 1.0) == [B, C]
    assert found.leading(2.2, WET, [A, B, C, D], -1.0) == []


def test_ineffective_constants_are_not_moved_further() -> None:
    found = table((A, 2.2, 0.0), (A, 0.4, 0.0), (B, 2.2, 0.0), (C, 2.2, 0.0), (C, 0.4, -1.0))
    assert found.moving([A, B, C, D]) == [B, C, D]
    assert [found.moves(one) for one in (A, B, C, D)] == [False, False, True, False]
    acting = table((A, 2.2, 0.0), (A, 0.4, 0.0), acting=lambda unit: True)
    assert acting.moving([A]) == [A]
    acting.enter((B, ALWAYS), 2.2, 5.0)
    assert acting.moving([A]) == []  # a gain shows the way, so changed commands no longer count


def test_largest_gain_counts_only_above_the_slack() -> None:
    assert Gains(1.0).best() == 0.0
    assert table((A, 2.2, -3.0)).best() == 0.0
    found = table((A, 2.2, 1.5))
    assert (found.best(), found.anything(), found.anything(1.5), found.anything(1.4)) == (
        1.5,
        True,
        False,
        True,
    )
    assert not table((A, 2.2, 1.0)).anything()
    assert found.most((A, ALWAYS)) == 1.5
    assert found.most((B, ALWAYS)) == 0.0


def test_ineffective_proposal_changed_nothing() -> None:
    found = table((A, 1.0, 0.0), (B, 1.0, 2.0), (C, 2.2, 0.0), proposed=True)
    assert [found.idle(one) for one in (A, B, C, D)] == [True, False, False, False]
    assert not table((A, 1.0, 0.0)).idle(A)


# acceptance


def test_designed_episodes_are_announced_for_new_seeds() -> None:
    heard: list[list[int]] = []

    def run(seed: int) -> Outcome:
        return Outcome(float(seed), True)

    designed = Designed(World(run, lambda seeds: heard.append([*map(int, seeds)])))  # type: ignore[call-overload]
    assert designed([3, 4]) == [3.0, 4.0]
    assert designed([4, 5]) == [4.0, 5.0]
    assert heard == [[3, 4], [5]]


def test_failure_tolerance_is_five_points_above_the_recording() -> None:
    reference = Reference((10.0, 8.0), 0.9, 0.5, 0.0)
    assert reference.tolerated == pytest.approx(0.15)
    assert replace(reference, pass_rate=0.01).tolerated == 1.0
    assert reference.mean == 9.0
    assert reference.least == -10.0  # twenty margins of 0.5, and 0 to 10
    assert replace(reference, highest=20.0).least == -10.0
    assert replace(reference, margin=5.0).least == -10.0
    assert replace(reference, margin=5.0, highest=20.0).least == -20.0
    assert replace(reference, margin=5.0, lowest=-4.0).least == -14.0


# reserves


@pytest.mark.parametrize(("seeds", "total", "released"), [(2, 6.0, True), (2, 5.9, False), (1, 9.0, False)])
def test_reserve_is_released_after_gains_on_two_seeds(seeds: int, total: float, released: bool) -> None:
    trials = Trials(lambda *_: Outcome(total, False), seeds, reserve=5, worth=GOAL)
    candidate = joint((A, 2.2)).candidate(mutations)
    for seed in range(seeds):
        trials(candidate, seed)
    if not released:
        with pytest.raises(BudgetSpentError):
            trials(candidate, 3)
        return
    trials(candidate, 3)
    assert (trials.budget, trials.reserve) == (seeds + 5, 0)


def test_missions_without_loss_do_not_count_for_the_reserve() -> None:
    goal = replace(GOAL, pairs=GOAL.pairs[:2], controls=(Pair(2, 10.0), Pair(3, 10.0)))
    trials = Trials(lambda *_: Outcome(10.0, True), 2, reserve=5, worth=goal)
    for seed in (2, 3):
        trials(joint((A, 2.2)).candidate(mutations), seed)
    with pytest.raises(BudgetSpentError):
        trials(joint((A, 2.2)).candidate(mutations), 0)


def test_outcomes_of_equal_candidates_are_known() -> None:
    one, two = (joint((unit, 2.2)).candidate(mutations) for unit in (A, B))
    trials = Trials(lambda candidate, seed: Outcome(float(seed), False), 9)
    trials(one, 3)
    trials(two, 4)
    trials.equate(one, two)
    assert [trials(two, seed).total for seed in (3, 4)] == [3.0, 4.0]
    assert trials.spent == 2
    other = Trials(lambda candidate, seed: Outcome(-1.0, False), 9)
    other(two, 4)
    other.know(trials)
    assert [other(one, 3).total, other(two, 3).total, other(two, 4).total] == [3.0, 3.0, -1.0]
    assert other.spent == 1


def test_second_factor_is_skipped_after_an_ineffective_one() -> None:
    gains = {A: {2.2: 5.0}, B: {2.2: 1.0}, C: {0.4: 1.0}}
    search, seen = selection(lambda by, seed: 5.0, gains=gains)
    assert list(search.candidates(joint((A, 2.2)))) == []
    assert first(seen) == ["A2.2", "A2.2 B2.2", "A2.2 C0.4"]
    search, seen = selection(lambda by, seed: 5.0 - (by.get("B") == 2.2), gains=gains)
    assert list(search.candidates(joint((A, 2.2)))) == []
    assert first(seen)[3:] == ["A2.2 B0.4", "A2.2 C2.2"]
