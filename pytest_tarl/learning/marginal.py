"""Compare worlds that have no cells in common, by leaving out the sensors whose values are new."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from pytest_tarl.learning.tables import END, START, Floats, Ints, ListSample, Sample, sum_by
from pytest_tarl.sensors import Cell

# worlds count as having no common cells if at most this share of the deployed steps is in recorded cells
FEW = 0.05
ENOUGH = 0.5  # sensors are left out until at least this share of the steps is in recorded cells


def left_out(offline: Sample, online: Sample) -> tuple[int, ...]:
    """Return the smallest set of sensors to leave out so that the worlds overlap.

    It is empty if the worlds already overlap, or cannot be made to overlap.
    """
    width = len(offline.cells[0]) if offline.cells else 0
    if _met(offline, online, tuple(range(width))) > FEW:
        return ()
    for size in range(width - 1, 0, -1):
        kept = max(combinations(range(width), size), key=lambda one: _met(offline, online, one))
        if _met(offline, online, kept) >= ENOUGH:
            return tuple(d for d in range(width) if d not in kept)
    return ()


def apart(offline: Sample, online: Sample) -> bool:
    """Return whether almost no deployed step is in a recorded cell."""
    return _met(offline, online, tuple(range(len(offline.cells[0]) if offline.cells else 0))) <= FEW


def _met(offline: Sample, online: Sample, kept: Sequence[int]) -> float:
    """Return the share of deployed steps in recorded cells if cells have only the sensors `kept`."""
    known = {_shortened(offline.cells[i], kept) for i in np.unique(offline.chain.cell).tolist()}
    steps = sum_by(online.chain.cell, online.chain.count, len(online.cells))
    inside = sum(steps[i] for i, cell in enumerate(online.cells) if _shortened(cell, kept) in known)
    return float(inside / steps.sum()) if steps.sum() else 1.0


def groups(cells: Sequence[Cell], without: Sequence[int]) -> tuple[tuple[Cell, ...], Ints]:
    """Remove the sensors `without` from all cells; return the distinct results, and each cell's row in them.

    The results are sorted; the rows have shape (cells,).
    """
    kept = [d for d in range(len(cells[0])) if d not in without] if cells else []
    short = [_shortened(cell, kept) for cell in cells]
    found = tuple(sorted(set(short)))
    row = {cell: i for i, cell in enumerate(found)}
    return found, np.array([row[cell] for cell in short], dtype=np.int64)


def projected(sample: Sample, without: Sequence[int]) -> Sample:
    """Return the sample without some sensors and without taint lists."""
    cells, row = groups(sample.cells, without)
    place = np.append(row, END)  # END is -1, so it maps to the last entry, END
    chain = replace(sample.chain, cell=place[sample.chain.cell], next_cell=place[sample.chain.next_cell])
    return replace(sample, cells=cells, chain=chain, lists=())


def lent(table: Floats, recorded: ListSample, cells: Sequence[Cell], without: Sequence[int]) -> Floats:
    """Fill the unknown entries of a table, shape (cells, sites), with the mean over similar cells.

    Similar cells differ only in the sensors left out. The mean is weighted by visits.
    """
    alike, row = groups(cells, without)
    visits = recorded.visits
    events = visits.state != START
    flat = sum_by(visits.state[events] - 1, visits.count[events], table.size).reshape(table.shape)
    weight = np.where(np.isnan(table), 0.0, flat)
    worth, often = (np.zeros((len(alike), table.shape[1])) for _ in range(2))
    np.add.at(worth, row, np.where(np.isnan(table), 0.0, table) * weight)
    np.add.at(often, row, weight)
    with np.errstate(invalid="ignore"):
        mean = (worth / often)[row]
    return np.where(np.isnan(table), mean, table)


def _shortened(cell: Cell, kept: Sequence[int]) -> Cell:
    return tuple(cell[d] for d in kept)
