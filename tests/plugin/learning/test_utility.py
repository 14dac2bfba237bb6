"""The learned utility equals the known values of Markov chains."""

from __future__ import annotations

import numpy as np
import pytest

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning import utility
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.sarsa import LEARNERS, ExpectedSarsa, Sarsa, TDLambda
from pytest_tarl.learning.sequences import EventSequence, event_sequences
from pytest_tarl.learning.statistics import sample
from pytest_tarl.learning.tables import END, START
from pytest_tarl.learning.utility import batch, chain_utility, fixed_point

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


def test_fixed_point_solves_the_random_walk() -> None:
    state = np.repeat(np.arange(WALK), 2)
    following = np.array([END, 1, 0, 2, 1, 3, 2, 4, 3, END])
    reward = np.array([0.0, 0.0, 0.0, 0.0, 1.0])  # one of the two exits of the last state earns 1
    values = fixed_point(state, following, np.ones(10, np.int64), reward, gamma=1.0)
    assert values == pytest.approx(np.arange(1, 6) / 6)


def test_a_state_that_is_never_left_has_no_utility() -> None:
    one = np.array([0])
    values = fixed_point(one, np.array([END]), np.array([1]), np.array([3.0, 0.0]), gamma=0.9)
    assert values[0] == 3.0
    assert np.isnan(values[1])


@pytest.mark.parametrize("kind", LEARNERS)
def test_batch_and_incremental_learners_agree_on_the_random_walk(kind: str) -> None:
    traces = [walk_trace(seed) for seed in range(1500)]
    whole = merge([sample(trace, seed, True, ((0,),)) for seed, trace in enumerate(traces)])
    learned = batch(whole.lists[0], WALK, scale=np.inf, gamma=1.0)[:, 0]
    assert learned == pytest.approx(np.arange(1, 6) / 6, abs=0.06)
    learner = LEARNERS[kind](1, gamma=1.0, alpha=0.02)
    for trace in traces:
        learner.learn(event_sequences(trace, (0,))[0], trace.cells)
    walked = learner.table(whole.cells, np.inf)[:, 0]
    assert walked == pytest.approx(learned, abs=0.08)
    steps = chain_utility(whole.chain, WALK, gamma=1.0)
    assert steps == pytest.approx(learned, abs=1e-9)


def test_sarsa_follows_its_update_rule() -> None:
    sequence = EventSequence(
        state=np.array([START, 1, 2]),
        reward=np.array([0.0, 1.0, 2.0]),
        scaled=np.array([0.0, 4.0, 0.0]),
        flow=np.array([0.0, 4.0, 0.0]),
    )
    learner = Sarsa(2, gamma=0.5, alpha=0.1)
    learner.learn(sequence, [(7,)])
    learner.learn(sequence, [(7,)])
    table = learner.table([(7,)], scale=2.0)
    first = 0.1 * 3.0  # ρ = 1 + 4/2
    assert table[0, 0] == pytest.approx(first + 0.1 * (3.0 + 0.5 * 0.2 - first))
    assert table[0, 1] == pytest.approx(0.2 + 0.1 * (2.0 - 0.2))


def sequence_of(states: list[int], rewards: list[float]) -> EventSequence:
    nothing = np.zeros(len(states))
    return EventSequence(np.array(states), np.array(rewards), nothing, nothing)


def test_expected_sarsa_averages_over_the_successors_seen_so_far() -> None:
    learner = ExpectedSarsa(2, gamma=0.5, alpha=0.5)
    learner.learn(sequence_of([START, 2], [0.0, 4.0]), [(0,)])  # q(2) = 2
    learner.learn(
        sequence_of([START, 1], [0.0, 0.0]), [(0,)]
    )  # either state can follow the start, and q(1) = 0
    learner.learn(sequence_of([START, 1, 2], [0.0, 8.0, 4.0]), [(0,)])
    first, second = learner.table([(0,)], np.inf)[0]
    assert first == pytest.approx(0.5 * (8.0 + 0.5 * (0.5 * 0.0 + 0.5 * 2.0)))  # END and 2 followed 1
    assert second == pytest.approx(2.0 + 0.5 * (4.0 - 2.0))


def test_td_lambda_covers_whole_return_and_single_step() -> None:
    whole, next_only = (TDLambda(2, gamma=0.5, alpha=0.5, trace=trace) for trace in (1.0, 0.0))
    for learner in (whole, next_only):
        learner.learn(sequence_of([START, 1, 2], [0.0, 1.0, 4.0]), [(0,)])
    assert whole.table([(0,)], np.inf).tolist() == [[0.5 * (1.0 + 0.5 * 4.0), 2.0]]
    assert next_only.table([(0,)], np.inf).tolist() == [[0.5 * 1.0, 2.0]]


def test_an_infinite_scale_switches_off_the_flow_values() -> None:
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


def test_sarsa_identifies_cells_by_value() -> None:
    learner = Sarsa(1, gamma=0.5, alpha=0.1)
    for cells, state in (([(4,)], 1), ([(9,), (4,)], 2)):
        sequence = EventSequence(np.array([START, state]), np.array([0.0, 1.0]), np.zeros(2), np.zeros(2))
        learner.learn(sequence, cells)
    table = learner.table([(4,), (9,), (5,)], np.inf)
    assert table[0, 0] == pytest.approx(0.1 + 0.1 * 0.9)
    assert np.isnan(table[1:, 0]).all()


def test_step_by_step_solution_equals_the_joint_one(monkeypatch: pytest.MonkeyPatch) -> None:
    draws = np.random.default_rng(3)
    state, following = np.repeat(np.arange(40), 5), draws.integers(-1, 40, 200)
    arguments = (state, following, draws.integers(1, 9, 200), draws.normal(size=40))
    at_once = fixed_point(*arguments, gamma=0.95)
    monkeypatch.setattr(utility, "DENSE", 10)
    assert fixed_point(*arguments, gamma=0.95) == pytest.approx(at_once, abs=1e-9)


def test_the_iteration_continues_if_conjugate_gradients_break_down(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(utility, "DENSE", 1)
    monkeypatch.setattr(utility, "STEPS", 2)
    state = np.arange(300)
    values = fixed_point(state, np.append(state[1:], END), np.ones_like(state), np.ones(300), gamma=0.9)
    assert values == pytest.approx(10 * (1 - 0.9 ** np.arange(300, 0, -1)))


def test_hundred_thousand_states_need_no_dense_matrix() -> None:
    state = np.arange(100_000)
    following = np.append(state[1:], END)
    values = fixed_point(state, following, np.ones_like(state), np.ones(state.size), gamma=0.5)
    assert values[0] == pytest.approx(2.0)


def test_a_world_without_cells_has_an_empty_utility() -> None:
    trace = Trace(
        cells=(),
        site=np.zeros(1, np.int32),
        flow=np.ones(1),
        event_cell=np.full(1, -1, np.int32),
        event_step=np.zeros(1, np.int32),
        step_cell=np.full(1, -1, np.int32),
        reward=np.ones(1),
        parts={},
    )
    learner = Sarsa(2)
    (sequence,) = event_sequences(trace, (0, 1))
    learner.learn(sequence, trace.cells)
    assert learner.table((), 1.0).shape == (0, 2)
    assert batch(sample(trace, 0, True, ((0, 1),)).lists[0], 0, 1.0).shape == (0, 2)
