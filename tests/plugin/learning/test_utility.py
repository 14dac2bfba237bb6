"""Utility against Markov chains whose values are known."""

from __future__ import annotations

import numpy as np
import pytest

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.statistics import END, START, EventSequence, sample
from pytest_tarl.learning.utility import batch, chain_utility, fixed_point, sarsa

WALK = 5  # Sutton & Barto, example 6.2: values 1/6 … 5/6


def random_walk(seed: int) -> list[int]:
    generator = np.random.default_rng(seed)
    places = [2]
    while 0 <= places[-1] < WALK:
        places.append(places[-1] + int(generator.integers(2)) * 2 - 1)
    return places


def walk_trace(seed: int) -> Trace:
    places = random_walk(seed)
    inside = places[:-1]
    steps = len(inside)
    reward = np.zeros(steps)
    reward[-1] = 1.0 if places[-1] == WALK else 0.0
    return Trace(
        cells=tuple((place,) for place in range(WALK)),
        site=np.zeros(steps, np.int32),
        flow=np.zeros(steps),
        event_cell=np.array(inside, np.int32),
        event_step=np.arange(steps, dtype=np.int32),
        step_cell=np.array(inside, np.int32),
        reward=reward,
        parts={},
    )


def test_the_fixed_point_solves_the_random_walk_exactly() -> None:
    state = np.repeat(np.arange(WALK), 2)
    following = np.array([END, 1, 0, 2, 1, 3, 2, 4, 3, END])
    reward = np.array([0.0, 0.0, 0.0, 0.0, 1.0])  # half of the last state's two exits earns 1
    values = fixed_point(state, following, np.ones(10, np.int64), reward, gamma=1.0)
    assert values == pytest.approx(np.arange(1, 6) / 6)


def test_a_state_never_left_has_no_utility() -> None:
    one = np.array([0])
    values = fixed_point(one, np.array([END]), np.array([1]), np.array([3.0, 0.0]), gamma=0.9)
    assert values[0] == 3.0
    assert np.isnan(values[1])


def test_batch_and_sarsa_agree_with_the_random_walk() -> None:
    traces = [walk_trace(seed) for seed in range(1500)]
    from pytest_tarl.learning.statistics import event_sequence, merge

    whole = merge([sample(trace, seed, True, ((0,),)) for seed, trace in enumerate(traces)])
    learned = batch(whole.lists[0], WALK, scale=np.inf, gamma=1.0)[:, 0]
    assert learned == pytest.approx(np.arange(1, 6) / 6, abs=0.06)
    walked = sarsa((event_sequence(t, (0,)) for t in traces), WALK, 1, np.inf, gamma=1.0, alpha=0.02)[:, 0]
    assert walked == pytest.approx(learned, abs=0.08)
    steps = chain_utility(whole.chain, WALK, gamma=1.0)
    assert steps == pytest.approx(learned, abs=1e-9)


def test_sarsa_follows_the_update_rule_by_hand() -> None:
    sequence = EventSequence(
        state=np.array([START, 1, 2]),
        reward=np.array([0.0, 1.0, 2.0]),
        scaled=np.array([0.0, 4.0, 0.0]),
        flow=np.array([0.0, 4.0, 0.0]),
    )
    table = sarsa([sequence, sequence], cells=1, sites=2, scale=2.0, gamma=0.5, alpha=0.1)
    first = 0.1 * 3.0  # ρ = 1 + 4/2
    assert table[0, 0] == pytest.approx(first + 0.1 * (3.0 + 0.5 * 0.2 - first))
    assert table[0, 1] == pytest.approx(0.2 + 0.1 * (2.0 - 0.2))


def test_the_flow_term_can_be_switched_off() -> None:
    trace = Trace(
        cells=((0,),),
        site=np.array([0, 1], np.int32),
        flow=np.array([5.0, 0.0]),
        event_cell=np.zeros(2, np.int32),
        event_step=np.zeros(2, np.int32),
        step_cell=np.zeros(1, np.int32),
        reward=np.array([1.0]),
        parts={},
    )
    recorded = sample(trace, 0, True, ((0, 1),)).lists[0]
    assert recorded.mean_flow == 2.5
    assert batch(recorded, 1, scale=np.inf, gamma=0.5).tolist() == [[0.5, 1.0]]
    assert batch(recorded, 1, scale=2.5, gamma=0.5).tolist() == [[2.5, 1.0]]
