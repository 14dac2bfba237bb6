"""Laws of the sufficient statistics, on random episodes."""

from __future__ import annotations

from dataclasses import replace

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from pytest_tarl.instrumentation.trace import Trace
from pytest_tarl.learning.merging import aligned, merge
from pytest_tarl.learning.sequences import event_sequences
from pytest_tarl.learning.statistics import sample, total_reward, total_rewards
from pytest_tarl.learning.tables import END, START, Sample

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


def tables(one: Sample) -> list[object]:
    return [one.chain, *(table for each in one.lists for table in (each.edges, each.visits, each))]


def same(first: Sample, second: Sample) -> bool:
    def columns(one: Sample) -> list[np.ndarray]:
        found = [column for table in tables(one) for column in vars(table).values()]
        return [one.total, one.passed, one.steps, *(c for c in found if isinstance(c, np.ndarray))]

    plain = (first.cells, first.seeds, first.part_names) == (second.cells, second.seeds, second.part_names)
    return plain and all(
        a.tobytes() == b.tobytes() for a, b in zip(columns(first), columns(second), strict=True)
    )


@given(st.integers(0, 10**6))
def test_event_rewards_add_up_to_the_total(seed: int) -> None:
    trace = random_trace(seed)
    for members in MEMBERS:
        (sequence,) = event_sequences(trace, members)
        assert sequence.reward.sum() == pytest.approx(trace.reward.sum())
    one = random_sample(seed)
    for recorded in one.lists:
        assert recorded.visits.reward.sum() == pytest.approx(one.total[0])


def threaded(seed: int, threads: int) -> Trace:
    """Return a trace of several threads, whose events are ordered by step and then by thread."""
    trace = random_trace(seed)
    thread = np.random.default_rng([seed, 1]).integers(0, threads, trace.site.size).astype(np.int32)
    order = np.lexsort((thread, trace.event_step))
    columns = {name: getattr(trace, name)[order] for name in ("site", "flow", "event_cell", "event_step")}
    return replace(trace, thread=thread[order], **columns)


def only(trace: Trace, thread: int) -> Trace:
    """Return the trace of one thread alone."""
    assert trace.thread is not None
    own = trace.thread == thread
    columns = {name: getattr(trace, name)[own] for name in ("site", "flow", "event_cell", "event_step")}
    return replace(trace, thread=None, **columns)


@given(st.integers(0, 10**6), st.integers(2, 4))
def test_threads_have_their_own_sequences(seed: int, threads: int) -> None:
    trace = threaded(seed, threads)
    for members in MEMBERS:
        found = event_sequences(trace, members)
        assert sum(one.reward.sum() for one in found) == pytest.approx(trace.reward.sum())
        alone = [event_sequences(only(trace, thread), members)[0] for thread in range(threads)]
        expected = [one for one in alone if one.state.size > 1] or alone[:1]
        assert [one.state.tolist() for one in found] == [one.state.tolist() for one in expected]
        assert [one.scaled.tolist() for one in found] == [one.scaled.tolist() for one in expected]


@given(st.integers(0, 10**6))
def test_events_of_two_threads_are_never_consecutive(seed: int) -> None:
    trace = threaded(seed, 2)
    assert trace.thread is not None
    apart = replace(
        trace, site=(trace.site + 4 * trace.thread).astype(np.int32)
    )  # the site identifies the thread
    recorded = sample(apart, seed, True, (tuple(range(8)),)).lists[0]
    inside = (recorded.edges.state != START) & (recorded.edges.next_state != END)
    first, then = (
        (column[inside] - 1) % 8 // 4 for column in (recorded.edges.state, recorded.edges.next_state)
    )
    assert (first == then).all()


@given(st.integers(0, 10**6))
def test_the_numbering_of_threads_does_not_matter(seed: int) -> None:
    trace = threaded(seed, 2)
    assert trace.thread is not None
    swapped = replace(trace, thread=1 - trace.thread)
    order = np.lexsort((swapped.thread, trace.event_step))
    columns = ("site", "flow", "event_cell", "event_step", "thread")
    swapped = replace(swapped, **{name: getattr(swapped, name)[order] for name in columns})
    for one, other in zip(
        sample(trace, 0, True, MEMBERS).lists, sample(swapped, 0, True, MEMBERS).lists, strict=True
    ):
        assert one.edges.count.tolist() == other.edges.count.tolist()
        assert one.visits.reward == pytest.approx(other.visits.reward)


def test_threads_active_in_one_step_share_its_reward() -> None:
    trace = Trace(
        cells=((0,),),
        site=np.array([0, 1, 0], np.int32),
        flow=np.ones(3),
        event_cell=np.zeros(3, np.int32),
        event_step=np.array([0, 0, 1], np.int32),
        step_cell=np.zeros(3, np.int32),
        reward=np.array([4.0, 6.0, 1.0]),
        parts={},
        thread=np.array([0, 1, 0], np.int32),
    )
    first, second = event_sequences(trace, (0, 1))
    assert (first.state.tolist(), first.reward.tolist()) == ([START, 1, 1], [0.0, 2.0, 7.0])
    assert (second.state.tolist(), second.reward.tolist()) == ([START, 2], [0.0, 2.0])


@given(st.lists(st.integers(0, 50), min_size=1, max_size=8), st.randoms(use_true_random=False))
@settings(max_examples=50)
def test_merging_is_independent_of_order(seeds: list[int], random: object) -> None:
    singles = [random_sample(seed) for seed in seeds]
    whole = merge(singles)
    assert whole.seeds == tuple(sorted(set(seeds)))
    shuffled = list(singles)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert same(merge(shuffled), whole)
    half = len(shuffled) // 2
    groups = [merge(group) for group in (shuffled[:half], shuffled[half:]) if group]
    assert same(merge(groups), whole)


def test_aligned_samples_keep_cells_and_sums() -> None:
    first, second = merge([random_sample(1), random_sample(2)]), random_sample(3)
    a, b = aligned(first, second)
    assert a.cells == b.cells == tuple(sorted({*first.cells, *second.cells}))
    assert a.chain.reward.sum() == pytest.approx(first.chain.reward.sum())
    for before, after in zip(first.lists, a.lists, strict=True):
        places = [first.cells[(s - 1) // before.width] for s in before.visits.state if s != START]
        moved = [a.cells[(s - 1) // after.width] for s in after.visits.state if s != START]
        assert sorted(places) == sorted(moved)


def test_silent_step_gives_its_reward_to_the_last_event() -> None:
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
    (sequence,) = event_sequences(trace, (0, 1))
    assert sequence.state.tolist() == [START, 1, 2, 1]
    assert sequence.reward.tolist() == [1.0, 0.0, 110.0, 11000.0]
    assert sequence.scaled.tolist() == [0.0, 20.0, 30.0, 1000.0]


def test_removed_sites_have_no_events() -> None:
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


@given(lengths=st.lists(st.integers(0, 300), max_size=12), seed=st.integers(0, 2**16))
@settings(max_examples=40)
def test_joint_totals_equal_single_episodes(lengths: list[int], seed: int) -> None:
    draws = np.random.default_rng(seed)
    reward = draws.normal(size=sum(lengths)) * 10.0 ** draws.integers(-8, 8, sum(lengths))
    ends = np.concatenate(([0], np.cumsum(np.array(lengths, np.int64))))
    alone = [total_reward(part) for part in np.split(reward, ends[1:-1])] if lengths else []
    assert total_rewards(reward, ends).tolist() == alone
