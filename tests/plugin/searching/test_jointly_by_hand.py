"""The parts of the joint search, with values worked out apart from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from math import e, exp, log

import numpy as np
import pytest

from pytest_tarl.patching.charts import SHARE
from pytest_tarl.patching.mutate import mutations
from pytest_tarl.searching import jointly
from pytest_tarl.searching.accept import Outcome
from pytest_tarl.searching.candidates import ALWAYS
from pytest_tarl.searching.forward_selection import ForwardSelection, Joint
from pytest_tarl.searching.gains import Gains
from pytest_tarl.searching.jointly import Jointly, Surrogate, sensitive
from pytest_tarl.searching.search import Candidate, Goal, Pair, Trials
from pytest_tarl.searching.units import Unit
from tests.plugin.searching.test_jointly import operand

A, B, C = (Unit((operand(line, name),)) for line, name in ((3, "A"), (4, "B"), (5, "C")))
POINTS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0], [-1.0, 1.0]])
VALUES = np.array([1.0, 3.0, 2.0, -2.0])


def matern(one: np.ndarray, other: np.ndarray, lengths: np.ndarray) -> float:
    """Return the correlation at the distance r in length scales: (1 + √5 r + 5 r² / 3) exp(-√5 r)."""
    far = np.sqrt((((one - other) / lengths) ** 2).sum())
    return float((1 + np.sqrt(5) * far + 5 * far**2 / 3) * np.exp(-np.sqrt(5) * far))


def likelihood(lengths: np.ndarray, noise: float, values: np.ndarray) -> float:
    """Return the log density of the standardised values, up to a constant."""
    among = np.array([[matern(one, other, lengths) for other in POINTS] for one in POINTS])
    among += noise**2 * np.identity(len(POINTS))
    scaled = (values - values.mean()) / values.std()
    return float(-0.5 * scaled @ np.linalg.inv(among) @ scaled - 0.5 * np.log(np.linalg.det(among)))


@pytest.mark.parametrize("lengths", [(1.0, 1.0), (0.4, 2.5)])
def test_a_surrogate_predicts_the_conditional_mean_and_deviation(lengths: tuple[float, float]) -> None:
    scales = np.array(lengths)
    noise = max(jointly.NOISES, key=lambda one: likelihood(scales, one, VALUES))
    among = np.array([[matern(one, other, scales) for other in POINTS] for one in POINTS])
    inverse = np.linalg.inv(among + noise**2 * np.identity(4))
    for place in ([0.5, 0.5], [1.0, 0.0], [9.0, 9.0]):
        near = np.array([matern(np.array(place), other, scales) for other in POINTS])
        mean, deviation = Surrogate(POINTS, VALUES, scales).predict(np.array([place]))
        assert mean[0] == pytest.approx(1.0 + VALUES.std() * near @ inverse @ ((VALUES - 1.0) / VALUES.std()))
        assert deviation[0] == pytest.approx(VALUES.std() * np.sqrt(1 - near @ inverse @ near))


def test_length_scales_are_found_one_by_one() -> None:
    best = np.ones(2)
    for at in range(2):
        tries = [best.copy() for _ in jointly.LENGTHS]
        for one, length in zip(tries, jointly.LENGTHS, strict=True):
            one[at] = length
        best = max([best, *tries], key=lambda one: likelihood(one, jointly.NOISES[-1], VALUES))
    assert Surrogate(POINTS, VALUES).fitted.tolist() == best.tolist()


def test_equal_values_are_predicted_everywhere() -> None:
    mean, deviation = Surrogate(POINTS, np.full(4, 7.0)).predict(np.array([[0.3, 0.2], [50.0, 50.0]]))
    assert mean.tolist() == [7.0, 7.0]
    assert deviation[1] == pytest.approx(1.0)
    assert deviation[0] < 0.9


def world(total: dict[frozenset[str], float], budget: int = 999) -> tuple[ForwardSelection, Trials, Goal]:
    """Return a world in which the names of the changed constants decide the reward."""

    def run(candidate: Candidate, _: int) -> Outcome:
        return Outcome(total.get(frozenset(one.operand.code for one in candidate.mutations), 0.0), False)

    goal = Goal(tuple(Pair(seed, 0.0) for seed in range(3)), near=9.0, enough=10.0, online=0.0)
    trials = Trials(run, budget)
    return ForwardSelection([A, B, C], mutations, trials, goal, {}, 0.5), trials, goal


def search(total: dict[frozenset[str], float], hidden: int = 0) -> tuple[Jointly, Trials]:
    selection, trials, goal = world(total)
    return Jointly([A, B, C], selection, trials, goal, np.random.default_rng(4), hidden), trials


@pytest.mark.parametrize(
    ("gain", "away", "value"),
    [
        (5.0, 0.0, 0.5),
        (20.0, 0.0, 1.0),
        (-20.0, 0.0, -1.0),
        (0.0, 1.5, -1.5),
        (0.0, 3.0, -2.0),
        (-20.0, 9.0, -3.0),
    ],
)
def test_trial_value_is_the_gain_minus_its_deviation(gain: float, away: float, value: float) -> None:
    found, _ = search({})
    assert found._valued(gain, away) == value
    found.goal = replace(found.goal, enough=0.0)  # nothing is wanted: the gain itself counts
    assert found._valued(0.25, 0.0) == 0.25


def test_fruitless_search_ends_after_twenty_five_trials() -> None:
    found, trials = search({})
    assert list(found.candidates([Joint(((B, e),), ALWAYS)], ALWAYS)) == []
    assert len(found._values) == jointly.PATIENCE
    assert found._points[:2] == [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)]  # the program itself, then the given start
    assert trials.spent <= jointly.PATIENCE + 1


def test_an_improvement_resets_the_count_of_trials_without_improvement() -> None:
    found, _ = search({frozenset("B"): 1.0, frozenset("C"): 2.0})
    starts = [Joint(((unit, e),), ALWAYS) for unit in (A, B, A, C)]
    assert list(found.candidates(starts, ALWAYS)) == []
    assert found._values[:5] == pytest.approx([0.0, 0.0, 0.1, 0.0, 0.2])
    assert len(found._values) == 5 + jointly.PATIENCE


def test_a_search_ends_after_its_episodes() -> None:
    selection, trials, goal = world({})
    trials.run = lambda _, __: Outcome(0.01 * trials.spent, False)  # each trial improves, so each runs twice
    found, steps = Jointly([A, B], selection, trials, goal, np.random.default_rng(4)), count(1)
    found._next = lambda: (0.05 * next(steps), 0.0)  # type: ignore[method-assign]
    assert list(found.candidates([], ALWAYS)) == []
    assert jointly.EPISODES <= trials.spent <= jointly.EPISODES + 1
    assert len(found._values) == 1 + jointly.EPISODES // 2


def test_best_trial_runs_on_a_second_seed() -> None:
    seeds: list[tuple[str, int]] = []
    selection, trials, goal = world({})

    def run(candidate: Candidate, seed: int) -> Outcome:
        seeds.append(("".join(one.operand.code for one in candidate.mutations), seed))
        return Outcome({"B": (3.0, 1.0)}.get(seeds[-1][0], (0.0, 0.0))[seed], False)

    trials.run = run
    found = Jointly([A, B], selection, trials, goal, np.random.default_rng(4))
    values: list[float | None] = []

    def tried(unit: Unit) -> Iterator[Candidate]:
        values.append((yield from found._value(Joint(((unit, 2.0),), ALWAYS), 0.1)))

    assert [*tried(A), *tried(B)] == []
    assert values == pytest.approx([0.0, 0.2])  # the mean gain of both seeds, as a share of 10
    assert seeds == [("A", 0), ("B", 0), ("B", 1)]


def test_steps_are_rounded_to_three_digits() -> None:
    assert Jointly._rounded(Joint(((A, 1.23456), (B, 0.0012345)), ALWAYS)).parts == ((A, 1.23), (B, 0.00123))


def test_proposals_change_three_constants_at_most() -> None:
    found, _ = search({})
    found._often = np.ones(6)
    starts = np.array([[0.0] * 6, [2.9, -2.9, 0.0, 0.0, 0.0, 1.0]])
    made = found._proposals(starts)
    assert made.shape == (jointly.PROPOSALS, 6)
    assert np.abs(made).max() == jointly.FARTHEST
    assert not ((np.abs(made) > 0) & (np.abs(made) < jointly.SMALL)).any()
    changed = np.array([(made[at] != starts[at % 2]).sum() for at in range(len(made))])
    assert changed.max() == 3
    assert {1, 2} <= set(changed.tolist())
    near = np.abs(made[::2])[made[::2] != 0]
    assert np.quantile(near, 0.1) < 0.15
    assert np.quantile(near, 0.95) > 0.8  # small, medium and large changes


def test_ineffective_constants_move_less_often() -> None:
    found, _ = search({}, hidden=1)
    assert found._often.tolist() == [1.0, 1.0, jointly.SELDOM]
    moved = (found._proposals(np.zeros((1, 3))) != 0).mean(axis=0)
    assert moved[2] < 0.75 * min(moved[:2])


def test_starts_are_good_points_far_apart() -> None:
    points = np.array([[0.0, 0.0], [0.1, 0.19], [0.2, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]])
    values = np.array([5.0, 9.0, 4.0, 3.0, 2.0, 1.0])
    assert jointly._best_apart(points, values).tolist() == [[0.1, 0.19], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]
    assert jointly._best_apart(points, -values).tolist() == [[3.0, 3.0], [2.0, 2.0], [1.0, 1.0], [0.2, 0.0]]


def test_constants_to_move_are_sorted_and_cut() -> None:
    gains = Gains(0.1)
    named = [Unit((operand(line, f"N{line}"),)) for line in range(10, 20)]
    literals = [Unit((replace(one.operands[0], definition=one.operands[0].span),)) for one in named[:3]]
    for at, unit in enumerate(named[:6]):
        gains.enter((unit, ALWAYS), 2.2, -1.0 - at)
    gains.enter((named[6], ALWAYS), 2.2, 0.1)
    for at, unit in enumerate(literals):
        gains.enter((unit, ALWAYS), 2.2, 20.0 + at)
    chosen, hidden = sensitive([*literals, *named], gains, ALWAYS)
    assert chosen == [*named[5::-1], literals[2], literals[1]]  # eight; named ones first, whatever the effect
    assert hidden == 0
    chosen, hidden = sensitive([*literals[:1], *named[4:]], gains, ALWAYS)
    assert (chosen, hidden) == ([named[5], named[4], literals[0], named[6], named[7]], 2)


def test_constant_moves_on_its_best_scale() -> None:
    gains, half = Gains(0.1), operand(3, "HALF", 0.5)
    plain, share = Unit((half,)), Unit((half,), SHARE)
    gains.enter((plain, ALWAYS), 2.2, 1.0)
    gains.enter((share, ALWAYS), 2.2, 3.0)
    assert sensitive([plain, share], gains, ALWAYS) == ([share], 0)
    gains.enter((plain, ALWAYS), 5.0, 4.0)
    assert sensitive([plain, share], gains, ALWAYS) == ([plain], 0)


def test_points_are_the_logarithms_of_the_steps() -> None:
    found, _ = search({})
    assert found._point(Joint(((B, 2.0), (C, 0.5)), ALWAYS)) == (0.0, log(2.0), log(0.5))
    assert exp(found._point(Joint((), ALWAYS))[0]) == 1.0
