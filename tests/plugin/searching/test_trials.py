"""Goals, the budget of episodes and the stored outcomes, for episodes with given rewards."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome, Reference, risk_of
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.confirming import _hardest_first, confirmed
from pytest_tarl.searching.search import (
    BudgetSpentError,
    Candidate,
    Goal,
    Pair,
    Trials,
    effective_value,
    label,
    operand_effect,
)
from tests.plugin.searching.test_search import operand

PAIRS = tuple(Pair(seed, float(seed)) for seed in range(4))
GOAL = Goal(PAIRS, near=8.0, enough=9.0, online=2.5, controls=(Pair(7, 9.0),))


def candidate(factor: float, line: int = 3) -> Candidate:
    made = mutations(operand(line, "2.0", 2.0), factor)
    assert made is not None
    return Candidate((made,), ALWAYS)


ONE, TWO, THREE = candidate(2.2), candidate(0.4), candidate(5.0)


def trials(totals: Mapping[Candidate, Mapping[int, float]], budget: int = 99) -> Trials:
    """Return trials in which the episodes with these totals have run."""
    made = Trials(lambda one, seed: Outcome(totals[one][seed], totals[one][seed] > 5.0), budget)
    for one, by_seed in totals.items():
        for seed in by_seed:
            made(one, seed)
    return made


def test_similar_candidate_takes_over_outcomes() -> None:
    made = trials({ONE: {0: 9.0, 1: 8.0}, TWO: {0: 7.0}})
    made.equate(ONE, TWO)
    assert made.totals_of(TWO, PAIRS) == {0: 7.0, 1: 8.0}
    assert made.spent == 3


def test_wanted_gain_comes_from_losing_episodes() -> None:
    assert GOAL.wanted == 9.0 - 1.5
    assert replace(GOAL, harder={0: 2.0, 2: 2.0}).wanted == 8.0 - 1.5
    assert replace(GOAL, pairs=()).wanted == 6.5
    assert replace(GOAL, enough=1.0).wanted == 0.0
    assert replace(GOAL, pairs=(), enough=1.0).wanted == 0.0


@pytest.mark.parametrize(
    ("total", "passed", "passing", "harder", "expected"),
    [
        (8.0, False, False, 0.0, True),
        (7.99, True, False, 0.0, False),
        (7.0, True, False, 1.0, True),
        (6.99, True, False, 1.0, False),
        (9.0, False, True, 0.0, False),
        (9.0, True, True, 0.0, True),
    ],
)
def test_goal_needs_total_and_mission(
    total: float, passed: bool, passing: bool, harder: float, expected: bool
) -> None:
    goal = replace(GOAL, passing=passing, harder={1: harder})
    assert goal.reached(Outcome(total, passed), 1) is expected
    assert goal.enough_on([0, 1]) == 9.0 - harder / 2


def test_a_repeated_request_for_an_episode_costs_no_budget() -> None:
    ran = trials({ONE: {0: 1.0, 1: 2.0}})
    assert ran(ONE, 0).total == 1.0
    assert (ran.spent, ran.totals, ran.labels) == (2, [1.0, 2.0], ["line 3: 2.0 → 4.4"] * 2)
    ran.charge()
    assert (ran.spent, ran.beside) == (3, 1)


def test_episodes_in_both_worlds_spend_the_budget() -> None:
    ran = Trials(lambda *_: Outcome(0.0, True), 2)
    ran.charge()
    ran(ONE, 0)
    with pytest.raises(BudgetSpentError):
        ran(ONE, 1)
    with pytest.raises(BudgetSpentError):
        ran.charge()
    assert ran(ONE, 0).total == 0.0  # known
    assert ran.spent == 2


def test_only_affordable_new_episodes_are_announced() -> None:
    asked: list[list[tuple[Candidate, int]]] = []
    ran = Trials(lambda *_: Outcome(0.0, True), 3, foresee=lambda wanted: asked.append([*wanted]))
    ran(ONE, 0)
    ran.expect([(ONE, 0), (ONE, 1), (TWO, 0), (TWO, 1)])
    ran(ONE, 1)
    ran(ONE, 2)
    ran.expect([(TWO, 0)])
    assert asked == [[(ONE, 1), (TWO, 0)], []]


@pytest.mark.parametrize(
    ("totals", "released"),
    [
        ({ONE: {0: 4.5, 1: 5.5}}, True),  # gains 4.5 = 60 % of 7.5
        ({ONE: {0: 4.4, 1: 5.5}}, False),
        ({ONE: {0: 9.0}, TWO: {1: 9.0}}, False),  # one seed each
        ({ONE: {0: 9.0, 7: 9.0}}, False),  # one of these missions lost nothing
        ({ONE: {0: 9.0, 8: 9.0}}, True),  # a rejected candidate lost the second one
        ({ONE: {0: 9.0, 8: -3.0}}, False),
    ],
)
def test_reserve_is_released_after_enough_gain(
    totals: dict[Candidate, dict[int, float]], released: bool
) -> None:
    ran = trials(totals, budget=2)
    ran.worth, ran.reserve = GOAL, 3
    ran.run = lambda *_: Outcome(0.0, True)
    if not released:
        with pytest.raises(BudgetSpentError):
            ran.charge()
        return
    for _ in range(3):
        ran.charge()
    assert (ran.budget, ran.reserve) == (5, 0)
    with pytest.raises(BudgetSpentError):
        ran.charge()


def test_gain_is_the_mean_over_seeds() -> None:
    ran = trials({ONE: {0: 4.0, 3: 4.0, 9: 70.0}})
    assert ran.gain(ONE, GOAL) == pytest.approx((4.0 + 1.0) / 2)


def test_effect_changes_reward_or_length_of_a_mission() -> None:
    pairs = (Pair(0, 1.0, 10), Pair(1, 1.0))
    for outcome, seed, expected in (
        (Outcome(1.0, True, steps=10), 0, False),
        (Outcome(1.0, True, steps=11), 0, True),
        (Outcome(1.5, True, steps=10), 0, True),
        (Outcome(1.0, True, steps=11), 1, False),  # the length of the unmutated mission is not known
        (Outcome(9.0, True, steps=11), 7, False),  # no such pair
    ):
        ran = Trials(lambda *_, outcome=outcome: outcome, 9)  # type: ignore[misc]
        ran(ONE, seed)
        assert ran.moved(ONE, pairs) is expected
        assert ran.steps(ONE, (*pairs, Pair(7, 0.0))) == [outcome.steps]
        assert ran.steps(TWO, pairs) == []


def test_candidates_agree_on_common_seeds() -> None:
    ran = trials({ONE: {0: 1.0, 1: 2.0, 2: 3.0}, TWO: {1: 2.0, 2: 3.0, 3: 9.0}, THREE: {2: 4.0, 1: 2.0}})
    assert ran.same_as(ONE, TWO) == 2
    assert ran.same_as(ONE, THREE) == 0
    assert ran.same_as(TWO, candidate(7.0)) == 0


def test_resembling_candidate_is_predicted_to_fail() -> None:
    ran = trials({ONE: {0: 6.0, 1: 6.0, 2: 9.0}, TWO: {0: 7.0, 1: 7.5}, THREE: {2: 0.0}})
    assert not ran.falls_short(TWO, PAIRS, 9.0)  # nothing fell short yet
    ran.fell_short(ONE, PAIRS)
    # the mean of ONE is 7, TWO is 1.25 better on the two common seeds
    assert ran.falls_short(TWO, PAIRS, 8.26)
    assert not ran.falls_short(TWO, PAIRS, 8.25)
    assert not ran.falls_short(THREE, PAIRS, 99.0)  # one common seed only


def test_confirmation_begins_with_two_hard_seeds() -> None:
    ran = Trials(lambda *_: Outcome(0.0, True), 9)
    goal = replace(GOAL, pairs=tuple(Pair(seed, 0.0) for seed in range(8)))
    assert _hardest_first(ran, goal, 6) == [7, 0, 1, 2, 3]
    ran.misses.update({3: 1, 4: 3, 5: 2, 6: 9})
    assert _hardest_first(ran, goal, 6) == [4, 5, 7, 0, 1]


@pytest.mark.parametrize(
    ("totals", "goal", "expected", "runs"),
    [
        ([9.0, 9.0, 9.0], GOAL, True, 3),
        ([9.0, 8.9, 9.0], GOAL, False, 3),  # near the goal on all seeds, but too little on average
        ([7.0, 10.0, 10.0], GOAL, True, 3),  # one seed may miss the goal
        ([7.0, 10.0, 7.0], GOAL, False, 3),
        ([7.0, 7.0, 10.0], GOAL, False, 2),
        ([10.0, 4.0, 10.0], replace(GOAL, passing=True), False, 2),
        ([10.0, 5.1, 12.0], replace(GOAL, passing=True), True, 3),
        ([12.0, 5.0, 12.0], replace(GOAL, passing=True, ranged=True), True, 3),
    ],
)
def test_confirmation_runs_until_decided(totals: list[float], goal: Goal, expected: bool, runs: int) -> None:
    ran = Trials(lambda _, seed: Outcome(totals[seed - 1], totals[seed - 1] > 5.0), 9)
    assert confirmed(ONE, ran, goal, 0) is expected
    assert ran.totals == totals[:runs]
    missed = {
        seed
        for seed, total in enumerate(totals[:runs], start=1)
        if not goal.reached(Outcome(total, total > 5.0), seed)
    }
    assert {*ran.misses} == missed


def test_candidate_with_known_losses_runs_nothing() -> None:
    ran = Trials(lambda *_: Outcome(10.0, True), 9, loses=lambda _: True)
    assert not confirmed(ONE, ran, GOAL, 0)
    assert ran.spent == 0


def test_designed_missions_are_charged_once_per_seed() -> None:
    ran = Trials(lambda *_: Outcome(2.0, True, rewards=(2.0, 0.0)), 9)
    assert ran.deviation(ONE, [0, 1]) == 0.0
    assert (ran.spent, ran.beside) == (2, 0)
    ran.design = lambda seed: Outcome(2.0, True, rewards=(1.0, 1.0) if seed else (2.0, 0.0))
    assert ran.deviation(ONE, [0, 1]) == pytest.approx((0.0 + 0.25) / 2)
    assert ran.deviation(TWO, [0, 1]) == pytest.approx(0.125)
    assert (ran.spent, ran.beside) == (6, 2)


def test_change_has_label_value_and_effect() -> None:
    literal = mutations(operand(3, "2.0", 2.0), 2.2)
    name = replace(operand(4, "KP", 3.0), definition=operand(1, "3.0", 3.0).span)
    factor = mutations(name, 2.2)
    assert literal is not None
    assert factor is not None
    assert label(Candidate((literal, factor), ALWAYS)) == "line 3: 2.0 → 4.4, line 4: KP × 2.2"
    assert (effective_value(literal), effective_value(factor)) == pytest.approx((4.4, 6.6))
    effect = operand_effect(factor, 1.5)
    assert (effect.code, effect.value, effect.effect, effect.factor) == ("KP", 3.0, 1.5, False)
    unknown = replace(factor, operand=replace(name, value=None))
    assert effective_value(unknown) == pytest.approx(2.2)
    assert operand_effect(unknown, 1.0).factor
    zero = replace(factor, operand=replace(name, value=0.0))
    assert effective_value(zero) == pytest.approx(2.2)


def test_the_risks_of_all_tests_sum_to_alpha() -> None:
    assert risk_of(0.06, 0) == pytest.approx(0.04)
    assert risk_of(0.06, 1) == pytest.approx(0.04 / 3)
    assert sum(risk_of(0.06, n) for n in range(40)) == pytest.approx(0.06)


def test_reference_tolerates_five_points_more_failures() -> None:
    one = Reference([4.0, 6.0], 0.9, 1.0, 5.0)
    assert one.mean == 5.0
    assert one.tolerated == pytest.approx(0.15)
    assert replace(one, pass_rate=0.02).tolerated == 1.0
    assert one.least == 4.0 - 6.0
    assert replace(one, lowest=-1.0).least == -7.0
    assert replace(one, lowest=-1.0, highest=8.0).least == -9.0
    assert replace(one, lowest=-99.0).least == -20.0


@pytest.mark.parametrize(
    ("steps", "passed", "sooner"),
    [((5, 6), False, True), ((5, 12), False, False), ((5, 6), True, False), ((5, None), False, False)],
    ids=["sooner", "one later", "passed", "unknown"],
)
def test_earlier_failure_must_hold_in_each_mission(
    steps: tuple[int, int | None], passed: bool, sooner: bool
) -> None:
    goal = Goal((Pair(0, 0.0, 10), Pair(1, 0.0, 11)), near=8.0, enough=9.0, online=0.0, passing=True)
    made = Trials(lambda _, seed: Outcome(1.0, passed, steps=steps[seed]), 9)
    assert not made.fails_sooner(ONE, goal)  # nothing ran
    for seed in (0, 1):
        made(ONE, seed)
    assert made.fails_sooner(ONE, goal) is sooner


@pytest.mark.parametrize(
    ("passed", "steps", "total", "feigned"),
    [
        (False, 121, 9.5, True),
        (True, 121, 9.5, False),  # it succeeded
        (False, 119, 9.5, False),  # it failed in time, perhaps narrowly
        (False, 121, 8.9, False),  # it does not earn enough
        (False, None, 9.5, False),
    ],
)
def test_gain_of_a_standing_mission_does_not_count(
    passed: bool, steps: int | None, total: float, feigned: bool
) -> None:
    goal = replace(GOAL, passing=True, steps=100.0)
    made = Trials(lambda _, __: Outcome(total, passed, steps=steps), 9)
    outcome = made(ONE, 0)
    assert goal.feigned(outcome) is feigned
    assert goal.gain(outcome, 1.5) == (0.0 if feigned else total - 1.5)
    assert made.gain(ONE, goal) == (0.0 if feigned else total)
    for other in (replace(goal, passing=False), replace(goal, steps=None)):
        assert not other.feigned(outcome)
        assert made.gain(ONE, other) == total
