"""Build the columns that a comparison tests: each episode's residuals, summed by cell and group of cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.residuals import beyond, fitted, in_fit, residuals
from pytest_tarl.learning.tables import Floats, Ints, Sample
from pytest_tarl.learning.tiles import tiled
from pytest_tarl.sensors import Cell, Sensor

NOVEL_VISITS = 3  # minimum number of visits to a cell outside the fit
NOVEL_EPISODES = 2  # minimum number of episodes that visit such a cell


@dataclass(frozen=True)
class Evidence:
    """The columns for comparing two worlds, shape (episodes, columns); deployed episodes come first.

    A drift may be strong in a few cells or weak in many, so there are also columns for slabs and for each episode's
    total reward. A slab is the set of all cells with the same bin of one sensor; its column is the sum over these
    cells.
    """

    move: Floats  # shape (episodes, cells), like the next two fields
    reward: Floats
    novel: Floats
    # largest rounding error of each entry of `move` and `reward`; smaller entries are set to 0
    move_error: Floats
    reward_error: Floats
    slabs: tuple[Ints, ...]  # row numbers of the cells in each slab
    totals: Floats

    def columns(self) -> tuple[Floats, ...]:
        """Return the blocks of columns, each (episodes, …): move, reward, novel, both slab blocks, totals."""
        parts = ((self.move, self.move_error), (self.reward, self.reward_error))
        slabs = [beyond(_summed(part, self.slabs), _summed(error, self.slabs)) for part, error in parts]
        return (self.move, self.reward, self.novel, *slabs, self.totals)

    def covered(self, significant: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which cells are in a significant slab, as booleans of shape (cells,)."""
        chosen = np.zeros(self.move.shape[1], dtype=bool)
        for slab in np.flatnonzero(significant).tolist():
            chosen[self.slabs[slab]] = True
        return chosen


def gathered(offline: Sample, online: Sample, sensors: Sequence[Sensor] = ()) -> Evidence:
    """Fit one half of the recorded episodes; compare the other half with the deployed ones."""
    fit = np.array([in_fit(seed) for seed in offline.seeds])
    rows = fit[offline.chain.episode]
    known = type(offline.chain)(*(column[rows] for column in vars(offline.chain).values()))
    model = fitted(known, len(offline.cells), tiled(offline.cells, sensors))
    held_out, deployed = residuals(offline, model), residuals(online, model)
    move, reward, novel, move_error, reward_error = (
        np.concatenate((getattr(deployed, part), getattr(held_out, part)[~fit]))
        for part in ("move", "reward", "novel", "move_error", "reward_error")
    )
    visited = ((novel > 0).sum(axis=0) >= NOVEL_EPISODES) & (novel.sum(axis=0) >= NOVEL_VISITS)
    totals = np.concatenate((online.total, offline.total[~fit]))[:, None]
    return Evidence(
        move,
        reward,
        np.where(visited, np.minimum(novel, 1.0), 0.0),
        move_error,
        reward_error,
        slabs(offline.cells),
        totals,
    )


def slabs(cells: Sequence[Cell]) -> tuple[Ints, ...]:
    """Return the row numbers of each slab's cells, as arrays of shape (cells of the slab,).

    There is a slab for every bin of every sensor, and a last slab with all cells. With only one sensor, each bin is a
    cell, so only the last slab is returned.
    """
    table = np.array(cells, dtype=np.int64).reshape(len(cells), -1)
    columns = table.T if table.shape[1] > 1 else ()
    shared = [np.flatnonzero(column == value) for column in columns for value in np.unique(column)]
    return (*shared, np.arange(len(cells)))


def _summed(part: Floats, slabs: Sequence[Ints]) -> Floats:
    """Return the sums over each slab, shape (episodes, slabs)."""
    return np.stack([part[:, rows].sum(axis=1) for rows in slabs], axis=1)
