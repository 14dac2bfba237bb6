"""Merge samples by seed.

Rows are sorted by key, so sums do not depend on which process recorded which episode.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TypeVar

import numpy as np

from pytest_tarl.learning.judgements import together
from pytest_tarl.learning.tables import END, START, Chain, Edges, Floats, Ints, ListSample, Sample, Visits
from pytest_tarl.sensors import Cell

Columns = TypeVar("Columns", Chain, Edges, Visits)


def merge(samples: Sequence[Sample], cells: Iterable[Cell] = ()) -> Sample:
    """Return the union of samples by seed; if several have the same seed, the first one wins.

    The table of cells has the cells of all samples, and those in `cells`. At least one sample is required.
    """
    cells = tuple(sorted({*cells, *(cell for one in samples for cell in one.cells)}))
    names = tuple(sorted({name for one in samples for name in one.part_names}))
    owner: dict[int, tuple[int, int]] = {}
    for which, one in enumerate(samples):
        for local, seed in enumerate(one.seeds):
            owner.setdefault(seed, (which, local))
    seeds = tuple(sorted(owner))
    picked = [owner[seed] for seed in seeds]
    episodes = [np.full(one.episodes, -1, dtype=np.int64) for one in samples]
    for rank, (which, local) in enumerate(picked):
        episodes[which][local] = rank
    number = {cell: i for i, cell in enumerate(cells)}
    places = [_place(one, episode, number, names) for one, episode in zip(samples, episodes, strict=True)]
    return Sample(
        cells=cells,
        seeds=seeds,
        passed=np.array([samples[w].passed[i] for w, i in picked]),
        total=np.array([samples[w].total[i] for w, i in picked]),
        steps=np.array([samples[w].steps[i] for w, i in picked], dtype=np.int64),
        part_names=names,
        chain=_stack([place.chain() for place in places], "cell", "next_cell"),
        lists=tuple(_merge_list(places, i, len(seeds)) for i in range(len(samples[0].lists))),
        judgements=together(samples, picked),
    )


def aligned(first: Sample, second: Sample) -> tuple[Sample, Sample]:
    """Return both samples with a common table of cells."""
    return merge([first], second.cells), merge([second], first.cells)


@dataclass(frozen=True)
class _Place:
    """Where the rows of a sample go in the merged sample.

    `episode` is -1 for an episode whose seed is in an earlier sample.
    """

    sample: Sample
    episode: Ints
    cell: Ints  # new row of each cell; END is -1, so it maps to the last entry, END
    part: Sequence[int]
    parts: int

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
        """Renumber states; START and END stay the same, and so does the shape."""
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

    def flow(self, i: int, merged: Floats) -> None:
        """Write a taint list's flows to this sample's rows of `merged`, shape (merged episodes, sites)."""
        kept = self.episode >= 0
        merged[self.episode[kept]] = self.sample.lists[i].flow[kept]

    def visits(self, i: int) -> Visits:
        visits = self.sample.lists[i].visits
        state = self.state(visits.state, self.sample.lists[i].width)
        return _kept(replace(visits, episode=self.episode[visits.episode], state=state))


def _place(one: Sample, episode: Ints, number: Mapping[Cell, int], names: Sequence[str]) -> _Place:
    cell = np.array([*(number[cell] for cell in one.cells), END], dtype=np.int64)
    return _Place(one, episode, cell, [names.index(name) for name in one.part_names], len(names))


def _merge_list(places: Sequence[_Place], i: int, episodes: int) -> ListSample:
    edges = _stack([place.edges(i) for place in places], "state", "next_state")
    visits = _stack([place.visits(i) for place in places], "state")
    width = places[0].sample.lists[i].width
    flow = np.zeros((episodes, width))
    for place in places:
        place.flow(i, flow)
    return ListSample(width, edges, visits, flow)


def _kept(columns: Columns) -> Columns:
    """Drop the rows of episodes that come from another sample."""
    keep = columns.episode >= 0
    return type(columns)(*(getattr(columns, f.name)[keep] for f in fields(columns)))


def _stack(tables: Sequence[Columns], *keys: str) -> Columns:
    """Concatenate tables and sort their rows by episode, then by `keys`."""
    kind = type(tables[0])
    whole = {f.name: np.concatenate([getattr(t, f.name) for t in tables]) for f in fields(kind)}
    order = np.lexsort([whole[key] for key in (*reversed(keys), "episode")])
    return kind(*(column[order] for column in whole.values()))
