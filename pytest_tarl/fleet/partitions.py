"""Tasks that run close to the data: score missions, or read the transitions of selected ones.

Workers read the files themselves. For each mission, they return one byte per score (its bin). For the missions that are
compared with the recording, they return the transitions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.fleet import dataset
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.schema import cell_of, name_of
from pytest_tarl.learning.packing import represented_chain
from pytest_tarl.learning.tables import END, Chain, Floats, Ints, Sample, sum_by
from pytest_tarl.monitoring.scores import Scale, binned
from pytest_tarl.sensors import Cell

ENTRIES = 1_000_000  # maximum size (missions × cells) of a table
CELLS = ("mission", "cell", "next_cell", "count", "reward")
RESULTS = ("mission", "passed", "total", "steps")


@dataclass(frozen=True)
class Wanted:
    """The selected missions of a part: their sorted IDs, and their numbers in the query."""

    cells: str  # file with the transitions between cells
    missions: str  # file with the results of the missions
    identities: NDArray[np.uint64]
    numbers: Ints

    def only(self, chosen: NDArray[np.bool_]) -> Wanted:
        """Return the missions where `chosen`, of shape (missions,), is true."""
        return replace(self, identities=self.identities[chosen], numbers=self.numbers[chosen])


@dataclass(frozen=True)
class Transitions:
    """Rows of transitions, sorted by all columns; `number` is the mission's number.

    `next_cell` is END after the last step.
    """

    number: Ints
    cell: Ints
    next_cell: Ints
    count: Ints
    reward: Floats

    def chain(self, numbers: Ints) -> Chain:
        """Return the transitions as a chain; a mission's index is its position in `numbers`.

        `numbers` has shape (missions,) and is ascending.
        """
        episode: Ints = np.asarray(np.searchsorted(numbers, self.number), np.int64)
        return Chain(
            episode, self.cell, self.next_cell, self.count, self.reward, np.zeros((self.cell.size, 0))
        )

    def of(self, numbers: Ints) -> Transitions:
        """Return the transitions of the missions with these (sorted) numbers."""
        low, high = np.searchsorted(self.number, numbers), np.searchsorted(self.number, numbers, side="right")
        sizes = high - low
        rows = np.repeat(low - np.cumsum(sizes) + sizes, sizes) + np.arange(int(sizes.sum()))
        return Transitions(*(column[rows] for column in vars(self).values()))

    def between(self, low: int, high: int) -> Transitions:
        """Return the transitions of the missions `low` to `high` - 1."""
        first, last = np.searchsorted(self.number, (low, high)).tolist()
        return Transitions(*(column[first:last] for column in vars(self).values()))


@dataclass(frozen=True)
class Scored:
    """The score bins, shape (missions, scores), and the visits to cells that are not in the recording."""

    numbers: Ints
    bins: NDArray[np.int8]
    new: tuple[tuple[int, Cell], ...]


def scored(where: Store, wanted: Sequence[Wanted], scale: Scale) -> Scored:
    """Score missions. Raise FleetError if a file cannot be read."""
    recorded, missions = len(scale.cells), np.concatenate([one.numbers for one in wanted])
    tables = [dataset.columns(where, one.cells, CELLS) for one in wanted]
    names = {name for one in tables for column in ("cell", "next_cell") for name in _names(one[column])}
    others = sorted({cell_of(name) for name in names} - set(scale.cells))
    number = numbered((*scale.cells, *others))
    rows = [_rows(table, one, number) for table, one in zip(tables, wanted, strict=True)]
    begins = np.cumsum([0, *(one.numbers.size for one in wanted)])
    places = [replace(one, number=one.number + begin) for one, begin in zip(rows, begins, strict=False)]
    whole = sorted_rows(places)
    new = np.unique(np.stack([whole.number, whole.cell], axis=1)[whole.cell >= recorded], axis=0)
    found = tuple((int(missions[place]), others[code - recorded]) for place, code in new.tolist())
    results = [_results(where, one) for one in wanted]
    passed, total, steps = (
        np.concatenate([one[name] for one in results]) for name in ("passed", "total", "steps")
    )
    width, bins = recorded + 1, []
    size = max(1, ENTRIES // width)
    for begin in range(0, missions.size, size):
        end = min(begin + size, missions.size)
        chain = watched_chain(whole.between(begin, end).chain(np.arange(begin, end)), recorded)
        some = (passed[begin:end], total[begin:end], steps[begin:end])
        bins.append(binned(scale, bare(width, *some, chain)).astype(np.int8))
    return Scored(missions, np.concatenate(bins), found)


def transitions(where: Store, wanted: Sequence[Wanted], number: Mapping[str, int]) -> Transitions:
    """Return the transitions of missions; `number` gives the code of each cell name.

    Raise FleetError if a file cannot be read.
    """
    found = []
    for one in wanted:
        rows = _rows(dataset.columns(where, one.cells, CELLS), one, number)
        found.append(replace(rows, number=one.numbers[rows.number]))
    return sorted_rows(found)


def numbered(cells: Sequence[Cell]) -> dict[str, int]:
    """Return cell name → number."""
    return {name_of(cell): number for number, cell in enumerate(cells)}


def _rows(table: Any, wanted: Wanted, number: Mapping[str, int]) -> Transitions:
    """Return the transitions of a part's missions, numbered by their position in `wanted`."""
    mission = _values(table["mission"], np.uint64)
    begins = (
        np.flatnonzero(np.append(True, mission[1:] != mission[:-1])) if mission.size else np.empty(0, int)
    )
    place = np.searchsorted(wanted.identities, mission[begins])
    place = np.minimum(place, max(0, wanted.identities.size - 1))
    known = wanted.identities[place] == mission[begins] if wanted.identities.size else place < 0
    sizes = np.diff(np.append(begins, mission.size))
    chosen = np.repeat(known, sizes)
    columns = (
        np.repeat(place, sizes),
        _codes(table["cell"], number),
        _codes(table["next_cell"], number),
        _values(table["count"], np.int64),
        _values(table["reward"], np.float64),
    )
    return Transitions(*(columns if chosen.all() else (column[chosen] for column in columns)))


def _results(where: Store, wanted: Wanted) -> dict[str, Any]:
    """Return whether each mission passed, with its total and steps, in the order of `wanted`."""
    table = dataset.columns(where, wanted.missions, RESULTS)
    mission = _values(table["mission"], np.uint64)
    order = np.argsort(mission, kind="stable")
    place = order[np.searchsorted(mission, wanted.identities, sorter=order)]
    kinds = {"passed": np.bool_, "total": np.float64, "steps": np.int64}
    return {name: _values(table[name], kind)[place] for name, kind in kinds.items()}


def sorted_rows(some: Sequence[Transitions]) -> Transitions:
    """Join rows in one table, sorted by all columns."""
    columns = {
        name: np.concatenate([np.empty(0, kind), *(getattr(one, name) for one in some)])
        for name, kind in (
            *((name, np.int64) for name in ("number", "cell", "next_cell", "count")),
            ("reward", np.float64),
        )
    }
    keys = [columns[name] for name in ("number", "cell", "next_cell")]
    width = 2 + max((int(one.max()) for one in keys[1:] if one.size), default=0)
    # keys are unique, because keys[2] ranges from END = -1 to width - 2
    key = (keys[0] * width + keys[1]) * width + keys[2]
    steps = np.diff(key)
    if (steps > 0).all():
        return Transitions(**columns)
    order = np.argsort(key, kind="stable")
    if (np.diff(key[order]) == 0).any():
        order = np.lexsort((columns["reward"], columns["count"], key))
    return Transitions(**{name: column[order] for name, column in columns.items()})


def watched_chain(chain: Chain, recorded: int) -> Chain:
    """Return the chain with all unrecorded cells replaced by a single one, and with rounded values."""
    return represented_chain(_without_others(chain, recorded))


def bare(cells: int, passed: Any, total: Floats, steps: Ints, chain: Chain) -> Sample:
    """Return missions as a sample without cell names; all arrays have shape (missions,)."""
    return Sample(((),) * cells, tuple(range(len(passed))), passed, total, steps, (), chain, ())


def _without_others(chain: Chain, recorded: int) -> Chain:
    """Replace all unrecorded cells by a single one, and merge equal transitions."""
    width = recorded + 1
    cell, after = np.minimum(chain.cell, recorded), np.minimum(chain.next_cell, recorded)
    if not ((chain.cell >= recorded).any() or (chain.next_cell >= recorded).any()):
        return chain
    codes, place = np.unique((chain.episode * width + cell) * (width + 1) + after + 1, return_inverse=True)
    return Chain(
        episode=codes // (width + 1) // width,
        cell=codes // (width + 1) % width,
        next_cell=codes % (width + 1) - 1,
        count=sum_by(place, chain.count, codes.size).astype(np.int64),
        reward=sum_by(place, chain.reward, codes.size),
        parts=np.zeros((codes.size, 0)),
    )


def _codes(column: Any, number: Mapping[str, int]) -> Ints:
    """Return the codes of cell names: END for null, -2 for an unknown cell."""
    parts = [np.empty(0, np.int64)]
    for chunk in _encoded(column).chunks:
        code = np.array([*(number.get(name, -2) for name in chunk.dictionary.to_pylist()), END], np.int64)
        index = chunk.indices.fill_null(len(code) - 1).to_numpy(zero_copy_only=False)
        parts.append(code[index])
    return np.concatenate(parts)


def _names(column: Any) -> set[str]:
    return {name for chunk in _encoded(column).chunks for name in chunk.dictionary.to_pylist()}


def _encoded(column: Any) -> Any:
    return column if hasattr(column.type, "index_type") else column.dictionary_encode()


def _values(column: Any, kind: Any) -> Any:
    return column.to_numpy().astype(kind, copy=False)


def portions(wanted: Sequence[Wanted], most: int) -> Iterator[list[Wanted]]:
    """Divide the selected missions into tasks of at most about `most` missions."""
    together: list[Wanted] = []
    for one in wanted:
        if not one.numbers.size:
            continue
        together.append(one)
        if sum(some.numbers.size for some in together) >= most:
            yield together
            together = []
    if together:
        yield together
