"""Combined repairs and joint searches, step by step, in worlds with given rewards."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import exp, log, pi, sqrt
from typing import Any

import numpy as np
import pytest

from pytest_tarl.errors import RepairError
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.epsilon_greedy import EpsilonGreedy
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint, Settled
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.jointly import (
    EPISODES,
    FLAT,
    Jointly,
    Surrogate,
    _best_apart,
    _kernel,
    expected_improvement,
    sensitive,
)
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_gains import constant

A, B, C, D = (Unit((constant(n, name),)) for n, name in enumerate("ABCD", start=1))
GOAL = Goal((Pair(0, 0.0), Pair(1, 0.0)), near=9.0, enough=9.0, online=0.0)
Earned = Callable[[Mapping[str, float]], float]


def selection(earned: Earned, units: tuple[Unit, ...] = (A, B, C), **gains: Mapping[float, float]) -> Any:
    """Return a forward selection in a world where factors of constants determine the reward."""

    def run(candidate: Candidate, seed: int) -> Outcome:
        return Outcome(earned({one.operand.code: float(one.value) for one in candidate.mutations}), True)

    known = {unit: gains[unit.operands[0].code] for unit in units if unit.operands[0].code in gains}
    return ForwardSelection(units, mutations, Trials(run, 999), GOAL, known, 0.5)


def factors(candidate: Candidate) -> dict[str, float]:
    return {one.operand.code: float(one.value) for one in candidate.mutations}


def finished(steps: Iterable[Candidate]) -> tuple[list[dict[str, float]], Any]:
    """Return the yielded values and the return value of a generator."""
    found: list[dict[str, float]] = []
    ended: list[Any] = []

    def through() -> Iterator[Candidate]:
        ended.append((yield from steps))

    found += map(factors, through())
    return found, ended[0]


def joint(*parts: tuple[Unit, float]) -> Joint:
    return Joint(parts, ALWAYS)


def test_parts_of_a_combination_are_replaced_and_dropped() -> None:
    both = joint((A, 2.0), (B, 3.0))
    assert both.with_part(A, 5.0).parts == ((B, 3.0), (A, 5.0))
    assert both.with_part(C, 5.0).parts == ((A, 2.0), (B, 3.0), (C, 5.0))
    assert both.without(A).parts == ((B, 3.0),)


def test_better_small_factor_starts_a_combination() -> None:
    chosen = selection(lambda _: 0.0, A={2.2: 1.0}, B={2.2: 1.0, 0.4: 2.0})
    added = [one.parts[-1] for turn in (0, 1) for one in chosen._with_another(joint((A, 2.2)), turn)]
    assert added == [(B, 0.4), (C, 2.2), (B, 2.2), (C, 0.4)]


def test_forward_selection_grows_while_gaining() -> None:
    def earned(by: Mapping[str, float]) -> float:
        return 4.0 * ("A" in by) + 3.0 * (by.get("B") == 2.2) + 5.5 * ("B" in by and "C" in by)

    chosen = selection(earned)
    found, _ = finished(chosen.candidates(joint((A, 2.2))))
    assert found[0] == {"A": 2.2, "B": 2.2, "C": 2.2}
    little = selection(lambda by: 4.0 * ("A" in by) + 0.5 * ("B" in by))
    found, _ = finished(little.candidates(joint((A, 2.2))))
    assert found == []
    assert all(len(label.split(",")) <= 2 for label in little.trials.labels)  # no third part


def test_sufficient_combination_loses_unneeded_parts() -> None:
    chosen = selection(lambda by: 10.0 if {"A", "B"} <= by.keys() else 0.0)
    found, gain = finished(chosen.gain(joint((A, 2.2), (B, 2.2), (C, 2.2))))
    assert (found, gain) == ([{"A": 2.2, "B": 2.2}], 10.0)
    found, gain = finished(chosen.gain(joint((A, 2.2), (B, 2.2), (D, 2.2))))
    assert (found, gain) == ([], 10.0)  # the same two parts again


def test_a_combination_that_cannot_be_written_has_no_gain() -> None:
    def run(_: Candidate, __: int) -> Outcome:
        raise RepairError("no", "no")

    chosen = ForwardSelection([A], mutations, Trials(run, 9), GOAL, {}, 0.5)
    assert finished(chosen.gain(joint((A, 2.2)))) == ([], None)
    assert finished(chosen.fewest(joint((A, 2.2)))) == ([], None)


def test_combination_values_are_refined_in_turn() -> None:
    chosen = selection(lambda by: -abs(log(by["A"] / 3.3)) - abs(log(by["B"] / 0.26)))
    _, (best, gain) = finished(chosen._balanced(joint((A, 2.2), (B, 0.4)), -9.0))
    assert best.parts == ((A, 3.3), (B, 0.26))
    assert gain == pytest.approx(0.0)


def test_search_keeps_the_fewest_changes() -> None:
    needs = selection(lambda by: 10.0 if {"A", "B"} <= by.keys() else 0.0)
    found, _ = finished(needs.fewest(joint(*((unit, 2.2) for unit in (A, B, C, D)))))
    assert found == [{"A": 2.2, "B": 2.2}]
    found, _ = finished(needs.fewest(joint((A, 2.2), (C, 2.2))))
    assert found == []
    every = selection(lambda by: 10.0 if len(by) == 4 else 0.0)
    found, _ = finished(every.fewest(joint(*((unit, 2.2) for unit in (A, B, C, D)))))
    assert found == []  # more than three parts


def test_pairs_come_before_triples() -> None:
    chosen = selection(lambda by: {1: 1.0, 2: 5.0 + ("B" in by), 3: 10.0}.get(len(by), 0.0), (A, B, C, D))
    found, _ = finished(chosen.unions([(A, 2.2), (B, 2.2), (C, 2.2), (D, 0.4)], ALWAYS))
    assert found
    assert len(found[0]) == 3
    assert {"A", "B"} <= found[0].keys()


def test_ineffective_constants_are_added_to_a_good_pair() -> None:
    def earned(by: Mapping[str, float]) -> float:
        return 10.0 if {"A", "B", "D"} <= by.keys() else {1: 1.0, 2: 6.0}.get(len(by), 0.0)

    parts = [(A, 2.2), (B, 2.2)]
    found, _ = finished(selection(earned).unions(parts, ALWAYS, [C, D]))
    assert found == [{"A": 2.2, "B": 2.2, "D": 5.0}]
    weak = selection(lambda by: earned(by) - 2.0)
    found, _ = finished(weak.unions(parts, ALWAYS, [C, D]))
    assert found == []


def test_a_candidate_is_confirmed_once() -> None:
    settled, one = Settled(), joint((A, 2.2)).candidate(mutations)
    trials = Trials(lambda *_: Outcome(10.0, True), 9)
    assert settled.holds(one, trials, GOAL, 0)
    assert not settled.holds(one, trials, GOAL, 0)
    assert settled.held == {one}
    refused = joint((B, 2.2)).candidate(mutations)
    trials.loses = lambda _: True
    assert not settled.holds(refused, trials, GOAL, 0)
    assert (settled.held, settled.tried) == ({one}, {one, refused})


def test_covariance_is_matern_five_halves() -> None:
    found = _kernel(np.array([[[0.0], [4.0]]]), np.array([2.0]))
    scaled = sqrt(5.0)  # at a distance of one length scale
    assert found == pytest.approx(np.array([[1.0, (1 + scaled + 5 / 3) * exp(-scaled)]]))


def test_the_expected_improvement_equals_its_formula() -> None:
    mean, deviation = np.array([3.0, 4.0]), np.array([2.0, 2.0])
    found = expected_improvement(mean, deviation, 3.0)
    assert found[0] == pytest.approx(2.0 / sqrt(2 * pi))  # at the best value, σ φ(0)
    density = exp(-0.125) / sqrt(2 * pi)
    assert found[1] == pytest.approx(1.0 * 0.6914625 + 2.0 * density, rel=1e-6)


def test_a_surrogate_fitted_to_equal_values_predicts_that_value() -> None:
    found = Surrogate(np.array([[0.0], [1.0]]), np.array([5.0, 5.0]), np.array([1.0]))
    mean, deviation = found.predict(np.array([[0.0], [99.0]]))
    assert mean == pytest.approx([5.0, 5.0])
    assert deviation[1] == pytest.approx(1.0)
    assert deviation[0] < 0.3


def test_the_best_points_are_chosen_with_a_minimum_distance() -> None:
    points = np.array([[0.0, 0.0], [0.1, 0.1], [0.0, 0.2], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]])
    values = np.array([9.0, 8.0, 7.0, 6.0, 6.0, 10.0])
    assert _best_apart(points, values).tolist() == [[3.0, 0.0], [0.0, 0.0], [0.0, 0.2], [1.0, 0.0]]


def jointly(earned: Earned, units: tuple[Unit, ...] = (A, B), hidden: int = 0) -> Jointly:
    chosen = selection(earned, units)
    return Jointly(units, chosen, chosen.trials, GOAL, np.random.default_rng(0), hidden)


def test_joint_search_begins_with_given_points() -> None:
    search = jointly(lambda by: 3.0 if by else 0.0)
    start = joint((B, 2.2))
    assert search._point(start) == (0.0, log(2.2))
    finished(search.candidates([start], ALWAYS))
    assert search._points[:2] == [(0.0, 0.0), (0.0, log(2.2))]
    assert search._values[:2] == pytest.approx([0.0, 3.0 / 9.0])
    assert len(search._points) == 2 + FLAT  # all others earn the same


def test_joint_search_finds_a_pair() -> None:
    def earned(by: Mapping[str, float]) -> float:
        return 10.0 - 2 * abs(log(by.get("A", 1.0) / 3)) - 2 * abs(log(by.get("B", 1.0) / 0.4))

    search = jointly(earned)
    found, _ = finished(search.candidates([joint((A, 2.2))], ALWAYS))
    assert found
    assert abs(log(found[0]["A"] / 3)) + abs(log(found[0]["B"] / 0.4)) <= 0.5
    assert search.trials.spent <= EPISODES + 1


def test_joint_search_subtracts_the_deviation() -> None:
    search = jointly(lambda _: 0.0)
    assert search._valued(4.5, 0.25) == 0.25
    assert search._valued(99.0, 0.0) == 1.0
    assert search._valued(-99.0, 9.0) == -1.0 - 2.0


def test_joint_search_lowers_points_that_failed_elsewhere() -> None:
    search = jointly(lambda _: 6.3)
    one = joint((A, 2.2))
    _, value = finished(search._value(one, 9.0))
    assert value == pytest.approx(0.7)
    search.selection.settled.tried.add(one.candidate(mutations))
    _, value = finished(search._value(one, 9.0))
    assert value == pytest.approx(0.2)


def test_proposals_move_one_to_three_coordinates() -> None:
    units = tuple(Unit((constant(n, f"N{n}"),)) for n in range(6))
    search = jointly(lambda _: 0.0, units, hidden=2)
    starts = np.zeros((2, 6))
    starts[1] = 2.9
    found = search._proposals(starts)
    moved = np.abs(found - starts[np.arange(len(found)) % 2]) > 0
    assert set(moved.sum(axis=1).tolist()) <= {0, 1, 2, 3}
    assert np.abs(found).max() <= 3.0
    assert not ((found != 0) & (np.abs(found) < 0.02)).any()
    often = moved.mean(axis=0)
    assert often[:4].min() > 1.5 * often[4:].max() > 0


def test_joint_search_moves_constants_that_gain() -> None:
    gains = Gains(0.5)
    literal = Unit((constant(9, "9.0"),))
    for unit, gain in ((A, 0.6), (B, -3.0), (C, 0.5), (D, 0.1), (literal, 9.0)):
        gains.enter((unit, ALWAYS), 2.2, gain)
    chosen, hidden = sensitive([A, B, C, D], gains, ALWAYS)
    assert (chosen, hidden) == ([B, A, C, D], 2)
    many = [Unit((constant(n, f"N{n}"),)) for n in range(20, 29)]
    for unit in many:
        gains.enter((unit, ALWAYS), 2.2, 5.0)
    chosen, hidden = sensitive([*many, C, D], gains, ALWAYS)
    assert (chosen, hidden) == (many[:8], 0)
    chosen, hidden = sensitive([*many[:7], C, D], gains, ALWAYS)
    assert (chosen, hidden) == ([*many[:7], C], 1)


def greedy(totals: Mapping[str, float], seeds: int, budget: int = 999) -> EpsilonGreedy:
    def run(candidate: Candidate, seed: int) -> Outcome:
        (name,) = factors(candidate)
        if name == "C":
            raise RepairError("cannot be written", "no")
        return Outcome(totals[name], True)

    goal = Goal((Pair(0, -5.0),), near=9.0, enough=9.0, online=1.0)
    operands = [unit.operands[0] for unit in (A, B, C)]
    generator = np.random.default_rng(0)
    return EpsilonGreedy(operands, mutations, (ALWAYS,), Trials(run, budget), goal, range(seeds), generator)


def test_epsilon_greedy_yields_sufficient_candidates() -> None:
    search = greedy({"A": 10.0, "B": 4.0}, 60)
    found = [factors(one) for one in search.candidates()]
    assert {name for one in found for name in one} == {"A"}
    effects = {name: one.effect for (one,) in search.effects().values() for name in [one.code]}
    assert effects == {"A": 9.0, "B": 3.0}  # a change that cannot be written has no effect
    assert search.refused
    assert len(found) <= EpsilonGreedy.CONFIRMED


def test_epsilon_greedy_needs_constants_and_a_budget() -> None:
    search = greedy({"A": 10.0, "B": 4.0}, 60, budget=0)
    search.actions = []
    assert [*search.candidates()] == []
    spent = greedy({"A": 4.0, "B": 4.0}, 60, budget=5)
    spent._learn()
    assert sum(map(len, spent.seen.values())) >= 5
    assert spent.trials.spent == 5
