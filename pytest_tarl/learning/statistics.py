"""Sufficient statistics of recorded episodes: all that utility and comparison need, per episode, mergeable.

Everything is columnar: one row per (episode, transition) or (episode, state). States of a taint list with
`width` sites are numbered 0 for the start of an episode and 1 + cell·width + n for site n in a cell; `END`
is where an episode goes after its last event. Merging is a union by seed; rows stand in key order, so sums
are taken in the same order and give the same bytes whoever recorded what.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.sensors import Cell

if TYPE_CHECKING:
    from pytest_tarl.instrumentation.trace import Trace

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

START = 0
END = -1


@dataclass(frozen=True)
class Chain:
    """Transitions of the sensor cell, one per simulation step; columns of shape (rows,), `parts` (rows, parts)."""

    episode: Ints
    cell: Ints
    next_cell: Ints
    count: Ints
    reward: Floats
    parts: Floats


@dataclass(frozen=True)
class Edges:
    """Transitions between states of one taint list; columns of shape (rows,)."""

    episode: Ints
    state: Ints
    next_state: Ints
    count: Ints


@dataclass(frozen=True)
class Visits:
    """Sums per state of one taint list: of r, of r·|f|, of |f|, and of the first two's squares; shape (rows,)."""

    episode: Ints
    state: Ints
    count: Ints
    reward: Floats
    scaled: Floats
    flow: Floats
    reward_squared: Floats
    scaled_squared: Floats


@dataclass(frozen=True)
class ListSample:
    """What was recorded of one taint list with `width` sites."""

    width: int
    edges: Edges
    visits: Visits

    @property
    def mean_flow(self) -> float:
        """Return F, the mean |f| per event; 1 where nothing flowed."""
        events = self.visits.count[self.visits.state != START].sum()
        mean = float(self.visits.flow.sum()) / events if events else 0.0
        return mean or 1.0


@dataclass(frozen=True)
class Sample:
    """Episodes in order of their seeds. `total` and `passed` have shape (episodes,); cells are sorted."""

    cells: tuple[Cell, ...]
    seeds: tuple[int, ...]
    passed: NDArray[np.bool_]
    total: Floats
    steps: Ints
    part_names: tuple[str, ...]
    chain: Chain
    lists: tuple[ListSample, ...]

    @property
    def episodes(self) -> int:
        """Return how many episodes there are."""
        return len(self.seeds)


@dataclass(frozen=True)
class EventSequence:
    """One episode as one taint list sees it: the start and then every event; columns of shape (events + 1,).

    `reward` holds what an event is given in full (it is the last of its step), `scaled` is r·|f|.
    """

    state: Ints
    reward: Floats
    scaled: Floats
    flow: Floats


def sum_by(index: Ints, weights: Floats | Ints, size: int) -> Floats:
    """Return the sum of the weights at each index, shape (size,)."""
    return np.bincount(index, weights=weights, minlength=size).astype(np.float64, copy=False)


def event_sequence(trace: Trace, members: Sequence[int]) -> EventSequence:
    """Return the subsequence of a taint list whose n-th site has the global number `members[n]`, -1 for none.

    A step without events gives its reward to the latest earlier event, else to the start: rewards sum
    to the episode's total. Events before the first cell are left out.
    """
    number = np.full(max([*members, int(trace.site.max(initial=-1)), 0]) + 1, -1, dtype=np.int64)
    for n, site in enumerate(members):
        if site >= 0:
            number[site] = n
    index = number[trace.site]
    chosen = (index >= 0) & (trace.event_cell >= 0)
    step = trace.event_step[chosen].astype(np.int64)
    flow = np.abs(trace.flow[chosen])
    state = 1 + trace.event_cell[chosen].astype(np.int64) * len(members) + index[chosen]
    own = trace.reward[step] if trace.reward.size else np.zeros(step.shape)
    return EventSequence(
        state=np.concatenate(([START], state)),
        reward=_given(step, trace.reward),
        scaled=np.concatenate(([0.0], own * flow)),
        flow=np.concatenate(([0.0], flow)),
    )


def _given(step: Ints, reward: Floats) -> Floats:
    """Give every step's reward to the last event that is not later; shape (events + 1,), the start first."""
    last = np.flatnonzero(np.append(step[1:] != step[:-1], True)) if step.size else np.empty(0, np.int64)
    owner = np.searchsorted(step[last], np.arange(reward.size), side="right")
    receivers = np.concatenate(([0], last + 1))[owner]
    return sum_by(receivers, reward, step.size + 1)


def relabelled(trace: Trace, cells: Sequence[Cell]) -> Trace:
    """Number the trace's cells as in `cells`, which must hold them all."""
    index = {cell: i for i, cell in enumerate(cells)}
    place = np.array([*(index[cell] for cell in trace.cells), -1], dtype=np.int32)
    return replace(
        trace, cells=tuple(cells), event_cell=place[trace.event_cell], step_cell=place[trace.step_cell]
    )


def sample(trace: Trace, seed: int, passed: bool, lists: Sequence[Sequence[int]]) -> Sample:
    """Return the statistics of one episode; `lists` holds each taint list's global site numbers."""
    cells = tuple(sorted(trace.cells))
    sorted_trace = relabelled(trace, cells)
    names = tuple(sorted(trace.parts))
    return Sample(
        cells=cells,
        seeds=(seed,),
        passed=np.array([passed]),
        total=np.array([float(np.sum(trace.reward))]),
        steps=np.array([trace.reward.size], dtype=np.int64),
        part_names=names,
        chain=_chain(sorted_trace, names),
        lists=tuple(_list_sample(event_sequence(sorted_trace, members), len(members)) for members in lists),
    )


def _chain(trace: Trace, names: Sequence[str]) -> Chain:
    known = trace.step_cell >= 0
    cell = trace.step_cell[known].astype(np.int64)
    following = np.append(cell[1:], END) if cell.size else cell
    pairs, inverse, count = _unique_pairs(cell, following)
    columns = [trace.parts[name][known] for name in names]
    summed = [sum_by(inverse, column, count.size) for column in columns]
    return Chain(
        episode=np.zeros(count.size, np.int64),
        cell=pairs[0],
        next_cell=pairs[1],
        count=count,
        reward=sum_by(inverse, trace.reward[known], count.size),
        parts=np.stack(summed, axis=1) if summed else np.zeros((count.size, 0)),
    )


def _list_sample(sequence: EventSequence, width: int) -> ListSample:
    following = np.append(sequence.state[1:], END)
    pairs, _, count = _unique_pairs(sequence.state, following)
    edges = Edges(np.zeros(count.size, np.int64), pairs[0], pairs[1], count)
    states, inverse, visits = np.unique(sequence.state, return_inverse=True, return_counts=True)

    def sums(column: Floats) -> Floats:
        return sum_by(inverse, column, states.size)

    return ListSample(
        width,
        edges,
        Visits(
            episode=np.zeros(states.size, np.int64),
            state=states,
            count=visits.astype(np.int64),
            reward=sums(sequence.reward),
            scaled=sums(sequence.scaled),
            flow=sums(sequence.flow),
            reward_squared=sums(sequence.reward**2),
            scaled_squared=sums(sequence.scaled**2),
        ),
    )


def _unique_pairs(first: Ints, second: Ints) -> tuple[tuple[Ints, Ints], Ints, Ints]:
    """Return the distinct (first, second) pairs in order, each row's pair and each pair's count."""
    span = int(max(first.max(initial=0), second.max(initial=0))) + 2
    codes, inverse, count = np.unique(first * span + (second + 1), return_inverse=True, return_counts=True)
    return (codes // span, codes % span - 1), inverse, count.astype(np.int64)


Columns = TypeVar("Columns", Chain, Edges, Visits)


def merge(samples: Sequence[Sample], cells: Iterable[Cell] = ()) -> Sample:
    """Return the union by seed; where a seed occurs twice the first sample wins. At least one sample is needed.

    The cells are those of all samples and the given ones.
    """
    cells = tuple(sorted({*cells, *(cell for one in samples for cell in one.cells)}))
    names = tuple(sorted({name for one in samples for name in one.part_names}))
    owner: dict[int, tuple[int, int]] = {}
    for which, one in enumerate(samples):
        for local, seed in enumerate(one.seeds):
            owner.setdefault(seed, (which, local))
    seeds = tuple(sorted(owner))
    places = [_Place(one, which, owner, seeds, cells, names) for which, one in enumerate(samples)]
    picked = [owner[seed] for seed in seeds]
    return Sample(
        cells=cells,
        seeds=seeds,
        passed=np.array([samples[w].passed[i] for w, i in picked]),
        total=np.array([samples[w].total[i] for w, i in picked]),
        steps=np.array([samples[w].steps[i] for w, i in picked], dtype=np.int64),
        part_names=names,
        chain=_stack([place.chain() for place in places], "cell", "next_cell"),
        lists=tuple(_merge_list(places, i) for i in range(len(samples[0].lists))),
    )


def aligned(first: Sample, second: Sample) -> tuple[Sample, Sample]:
    """Return both over one table of cells, so that their rows can be compared."""
    return merge([first], second.cells), merge([second], first.cells)


class _Place:
    """Where the rows of one sample go in the merged one."""

    def __init__(
        self,
        one: Sample,
        which: int,
        owner: dict[int, tuple[int, int]],
        seeds: tuple[int, ...],
        cells: tuple[Cell, ...],
        names: tuple[str, ...],
    ) -> None:
        self.sample = one
        index = {cell: i for i, cell in enumerate(cells)}
        self.cell = np.array([*(index[cell] for cell in one.cells), END], dtype=np.int64)
        rank = {seed: i for i, seed in enumerate(seeds)}
        kept = [owner[seed] == (which, local) for local, seed in enumerate(one.seeds)]
        self.episode = np.array(
            [rank[s] if k else -1 for s, k in zip(one.seeds, kept, strict=True)], dtype=np.int64
        )
        self.part = [names.index(name) for name in one.part_names]
        self.parts = len(names)

    def chain(self) -> Chain:
        chain = self.sample.chain
        parts = np.zeros((chain.count.size, self.parts))
        parts[:, self.part] = chain.parts
        moved = replace(
            chain,
            episode=self.episode[chain.episode],
            cell=self.cell[chain.cell],
            next_cell=self.cell[chain.next_cell],
            parts=parts,
        )
        return _kept(moved)

    def state(self, state: Ints, width: int) -> Ints:
        """Renumber states; the start and the end stay."""
        cell, site = np.divmod(np.maximum(state - 1, 0), max(width, 1))
        return np.where(state > START, 1 + self.cell[cell] * width + site, state) if state.size else state

    def edges(self, i: int) -> Edges:
        width, edges = self.sample.lists[i].width, self.sample.lists[i].edges
        moved = Edges(
            self.episode[edges.episode],
            self.state(edges.state, width),
            self.state(edges.next_state, width),
            edges.count,
        )
        return _kept(moved)

    def visits(self, i: int) -> Visits:
        visits = self.sample.lists[i].visits
        state = self.state(visits.state, self.sample.lists[i].width)
        return _kept(replace(visits, episode=self.episode[visits.episode], state=state))


def _merge_list(places: Sequence[_Place], i: int) -> ListSample:
    edges = _stack([place.edges(i) for place in places], "state", "next_state")
    visits = _stack([place.visits(i) for place in places], "state")
    return ListSample(places[0].sample.lists[i].width, edges, visits)


def _kept(columns: Columns) -> Columns:
    """Drop the rows of episodes that another sample holds."""
    keep = columns.episode >= 0
    return type(columns)(*(getattr(columns, f.name)[keep] for f in fields(columns)))


def _stack(tables: Sequence[Columns], *keys: str) -> Columns:
    """Concatenate and sort by episode and then by `keys`."""
    kind = type(tables[0])
    whole = {f.name: np.concatenate([getattr(t, f.name) for t in tables]) for f in fields(kind)}
    order = np.lexsort([whole[key] for key in (*reversed(keys), "episode")])
    return kind(*(column[order] for column in whole.values()))
