"""Compute the sufficient statistics of an episode, for the utility and the comparison.

Statistics of several episodes can be merged (merging.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.sequences import EventSequence, event_sequences
from pytest_tarl.learning.tables import (
    END,
    START,
    Chain,
    Edges,
    Floats,
    Ints,
    ListSample,
    Sample,
    Visits,
    sum_by,
)
from pytest_tarl.sensors import Cell

if TYPE_CHECKING:
    from pytest_tarl.instrumentation.trace import Trace

CANCELLED = 1e-13  # a sum below this share of its terms' magnitudes is a rounding error
# pairs are counted in a table if there are at most this many possible pairs per row; otherwise they are sorted
DENSE = 4


def sample(trace: Trace, seed: int, passed: bool, lists: Sequence[Sequence[int]]) -> Sample:
    """Return the statistics of one episode; `lists` has the global site numbers of each taint list."""
    cells = tuple(sorted(trace.cells))
    sorted_trace = _relabelled(trace, cells)
    names = tuple(sorted(trace.parts))
    return Sample(
        cells=cells,
        seeds=(seed,),
        passed=np.array([passed]),
        total=np.array([total_reward(trace.reward)]),
        steps=np.array([trace.reward.size], dtype=np.int64),
        part_names=names,
        chain=_chain(sorted_trace, names),
        lists=tuple(_list_sample(event_sequences(sorted_trace, members), len(members)) for members in lists),
    )


def _relabelled(trace: Trace, cells: Sequence[Cell]) -> Trace:
    """Return the trace with its cells numbered as in `cells`, which must contain them all."""
    index = {cell: i for i, cell in enumerate(cells)}
    place = np.array([*(index[cell] for cell in trace.cells), -1], dtype=np.int32)
    return replace(
        trace, cells=tuple(cells), event_cell=place[trace.event_cell], step_cell=place[trace.step_cell]
    )


def _chain(trace: Trace, names: Sequence[str]) -> Chain:
    known = trace.step_cell >= 0
    cell = trace.step_cell[known].astype(np.int64)
    following = np.append(cell[1:], END) if cell.size else cell
    pairs, inverse, count = _unique_pairs(cell, following)
    columns = [trace.parts[name][known] for name in names]
    sums = [summed(inverse, column, count.size) for column in columns]
    return Chain(
        episode=np.zeros(count.size, np.int64),
        cell=pairs[0],
        next_cell=pairs[1],
        count=count,
        reward=summed(inverse, trace.reward[known], count.size),
        parts=np.stack(sums, axis=1) if sums else np.zeros((count.size, 0)),
    )


def total_reward(reward: Floats) -> float:
    """Return the sum of an episode's rewards, shape (steps,); exactly 0 if they cancel."""
    total, size = float(np.add.reduce(reward)), float(np.add.reduce(np.abs(reward)))
    return total if abs(total) > CANCELLED * size else 0.0


def total_rewards(reward: Floats, ends: Ints) -> Floats:
    """Return the total reward of each episode, with the same bits as `total_reward`.

    `ends`, of shape (episodes + 1,), has the boundaries of the episodes. Episodes of equal length are summed together:
    numpy gives the sum of a matrix row the same bits as the sum of the row alone.
    """
    lengths = np.diff(ends)
    found = np.zeros(lengths.size)
    for length in np.unique(lengths).tolist():
        which = np.flatnonzero(lengths == length)
        rows = reward[ends[which][:, None] + np.arange(length)]
        found[which] = _cancelled(np.add.reduce(rows, axis=1), np.add.reduce(np.abs(rows), axis=1))
    return found


def summed(index: Ints, column: Floats, size: int) -> Floats:
    """Return the sum of the column at each index, shape (size,); exactly 0 if the values cancel."""
    return _cancelled(sum_by(index, column, size), sum_by(index, np.abs(column), size))


def _cancelled(sums: Floats, sizes: Floats) -> Floats:
    """Set sums to 0 if they are only rounding errors."""
    return np.where(np.abs(sums) > CANCELLED * sizes, sums, 0.0)


def _list_sample(sequences: Sequence[EventSequence], width: int) -> ListSample:
    state, reward, scaled, flow = (
        _joined([getattr(one, column) for one in sequences])
        for column in ("state", "reward", "scaled", "flow")
    )
    following = _joined([_followers(one.state) for one in sequences])
    pairs, _, count = _unique_pairs(state, following, False)
    edges = Edges(np.zeros(count.size, np.int64), pairs[0], pairs[1], count)
    visits = np.bincount(state)
    states = np.flatnonzero(visits)

    def sums(column: Floats) -> Floats:
        return sum_by(state, column, visits.size)[states]

    return ListSample(
        width,
        edges,
        Visits(
            episode=np.zeros(states.size, np.int64),
            state=states,
            count=visits[states],
            reward=sums(reward),
            scaled=sums(scaled),
            reward_squared=sums(reward * reward),
            scaled_squared=sums(scaled * scaled),
        ),
        flow=_flows(states, sums(flow), width),
    )


def _joined(columns: Sequence[NDArray[Any]]) -> NDArray[Any]:
    return columns[0] if len(columns) == 1 else np.concatenate(columns)


def _followers(state: Ints) -> Ints:
    """Return the state after each event, with END after the last one."""
    following = np.empty_like(state)
    following[:-1], following[-1:] = state[1:], END
    return following


def _flows(state: Ints, flow: Floats, width: int) -> Floats:
    """Return each site's sum of |f| over all cells, shape (1, sites)."""
    events = state != START
    return sum_by((state[events] - 1) % max(width, 1), flow[events], width)[None, :]


def _unique_pairs(first: Ints, second: Ints, inverse: bool = True) -> tuple[tuple[Ints, Ints], Ints, Ints]:
    """Return the distinct (first, second) pairs in order, each row's pair index, and the counts.

    The index is computed only with `inverse`. If few pairs are possible, they are counted in a table, which is much
    faster than sorting.
    """
    span = int(max(first.max(initial=0), second.max(initial=0))) + 2
    codes = first * span
    codes += second
    codes += 1
    if span * span > DENSE * first.size:
        distinct, place, count = np.unique(codes, return_inverse=True, return_counts=True)
        return (distinct // span, distinct % span - 1), place, count.astype(np.int64)
    counts = np.bincount(codes, minlength=span * span)
    distinct = np.flatnonzero(counts)
    place = np.empty(0, np.int64)
    if inverse:
        number = np.zeros(span * span, np.int64)
        number[distinct] = np.arange(distinct.size)
        place = number[codes]
    return (distinct // span, distinct % span - 1), place, counts[distinct]
