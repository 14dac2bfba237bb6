"""Laws of the sufficient statistics, on random episodes."""

from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.statistics import START, Sample, aligned, event_sequence, merge, sample

MEMBERS = ((0, 1, 2), (3, 1))


def random_trace(seed: int, *, cells: int = 4, sites: int = 4) -> Trace:
    generator = np.random.default_rng(seed)
    steps, events = int(generator.integers(1, 12)), int(generator.integers(0, 40))
    names = generator.permutation(cells * 3)[:cells]
    return Trace(
        cells=tuple((int(name), int(name) % 2) for name in names),
        site=generator.integers(0, sites, events).astype(np.int32),
        flow=generator.normal(size=events),
        event_cell=generator.integers(-1, cells, events).astype(np.int32),
        event_step=np.sort(generator.integers(0, steps, events)).astype(np.int32),
        step_cell=generator.integers(-1, cells, steps).astype(np.int32),
        reward=generator.normal(size=steps),
        parts={"progress": generator.normal(size=steps)},
    )


def random_sample(seed: int) -> Sample:
    return sample(random_trace(seed), seed, seed % 3 != 0, MEMBERS)


def same(first: Sample, second: Sample) -> bool:
    def columns(one: Sample) -> list[np.ndarray]:
        tables = [one.chain, *(t for each in one.lists for t in (each.edges, each.visits))]
        return [one.total, one.passed, one.steps, *(column for t in tables for column in vars(t).values())]

    plain = (first.cells, first.seeds, first.part_names) == (second.cells, second.seeds, second.part_names)
    return plain and all(
        a.tobytes() == b.tobytes() for a, b in zip(columns(first), columns(second), strict=True)
    )


@given(st.integers(0, 10**6))
def test_rewards_over_events_sum_to_the_episodes_total(seed: int) -> None:
    trace = random_trace(seed)
    for members in MEMBERS:
        sequence = event_sequence(trace, members)
        assert sequence.reward.sum() == pytest.approx(trace.reward.sum())
    one = random_sample(seed)
    for recorded in one.lists:
        assert recorded.visits.reward.sum() == pytest.approx(one.total[0])


@given(st.lists(st.integers(0, 50), min_size=1, max_size=8), st.randoms(use_true_random=False))
@settings(max_examples=50)
def test_merging_is_a_union_by_seed_in_any_order_and_grouping(seeds: list[int], random: object) -> None:
    singles = [random_sample(seed) for seed in seeds]
    whole = merge(singles)
    assert whole.seeds == tuple(sorted(set(seeds)))
    shuffled = list(singles)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert same(merge(shuffled), whole)
    half = len(shuffled) // 2
    groups = [merge(group) for group in (shuffled[:half], shuffled[half:]) if group]
    assert same(merge(groups), whole)


def test_aligned_samples_share_their_cells_and_keep_their_sums() -> None:
    first, second = merge([random_sample(1), random_sample(2)]), random_sample(3)
    a, b = aligned(first, second)
    assert a.cells == b.cells == tuple(sorted({*first.cells, *second.cells}))
    assert a.chain.reward.sum() == pytest.approx(first.chain.reward.sum())
    for before, after in zip(first.lists, a.lists, strict=True):
        places = [first.cells[(s - 1) // before.width] for s in before.visits.state if s != START]
        moved = [a.cells[(s - 1) // after.width] for s in after.visits.state if s != START]
        assert sorted(places) == sorted(moved)


def test_a_step_without_events_gives_its_reward_to_the_latest_earlier_event() -> None:
    trace = Trace(
        cells=((0,),),
        site=np.array([0, 1, 0], np.int32),
        flow=np.array([2.0, -3.0, 1.0]),
        event_cell=np.zeros(3, np.int32),
        event_step=np.array([1, 1, 3], np.int32),
        step_cell=np.zeros(5, np.int32),
        reward=np.array([1.0, 10.0, 100.0, 1000.0, 10000.0]),
        parts={},
    )
    sequence = event_sequence(trace, (0, 1))
    assert sequence.state.tolist() == [START, 1, 2, 1]
    assert sequence.reward.tolist() == [1.0, 0.0, 110.0, 11000.0]
    assert sequence.scaled.tolist() == [0.0, 20.0, 30.0, 1000.0]


def test_sites_that_the_node_no_longer_has_record_nothing() -> None:
    trace = random_trace(5)
    recorded = sample(trace, 5, True, ((0, -1, 2),)).lists[0]
    assert recorded.width == 3
    assert not any((s - 1) % 3 == 1 for s in recorded.visits.state if s != START)


def test_the_chain_counts_every_step_with_a_known_cell() -> None:
    trace = random_trace(7)
    chain = sample(trace, 7, True, MEMBERS).chain
    known = trace.step_cell >= 0
    assert chain.count.sum() == known.sum()
    assert chain.reward.sum() == pytest.approx(trace.reward[known].sum())
    assert chain.parts.sum() == pytest.approx(trace.parts["progress"][known].sum())
