"""Score all selected missions; each score takes one byte."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.fleet import partitions
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.database import Database
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring.scores import Scale
from pytest_tarl.sensors import Cell

PORTION = 25_000  # number of missions scored in one task


@dataclass(frozen=True)
class Scores:
    """Missions in any order: results, start in seconds since 1970, and score bins, shape (missions, scores).

    Each visit to a cell that is not in the recording has an entry in two arrays: `new_mission`, the index of the
    mission (ascending), and `new_cell`, the index of the cell in `others`.
    """

    passed: NDArray[np.bool_]
    total: Floats
    steps: Ints
    time: Floats
    bins: NDArray[np.int8]
    new_mission: Ints
    new_cell: Ints
    others: tuple[Cell, ...]

    def between(self, begin: int, end: int) -> Scores:
        """Return the missions `begin` to `end` - 1."""
        first, last = np.searchsorted(self.new_mission, (begin, end)).tolist()
        return Scores(
            self.passed[begin:end],
            self.total[begin:end],
            self.steps[begin:end],
            self.time[begin:end],
            self.bins[begin:end],
            self.new_mission[first:last] - begin,
            self.new_cell[first:last],
            self.others,
        )

    def ordered(self, order: Ints) -> Scores:
        """Return the missions in the given order, a permutation of shape (missions,)."""
        place = np.empty_like(order)
        place[order] = np.arange(order.size)
        moved = place[self.new_mission]
        rows = np.lexsort((self.new_cell, moved))
        return Scores(
            self.passed[order],
            self.total[order],
            self.steps[order],
            self.time[order],
            self.bins[order],
            moved[rows],
            self.new_cell[rows],
            self.others,
        )

    def new(self) -> list[Cell]:
        """Return the unrecorded cells, once for each mission that visited them."""
        return [self.others[number] for number in self.new_cell.tolist()]


def scored(database: Database, where: Store, scale: Scale, engine: Engine) -> Scores:
    """Score all missions, in the order of their numbers."""
    results = database.columns("SELECT passed, total, steps, time FROM missions ORDER BY number")
    bins = np.empty((len(results["total"]), len(scale.edges)), np.int8)
    new: list[tuple[int, Cell]] = []
    tasks = ((where, some, scale) for some in partitions.portions(database.wanted, PORTION))
    for found in engine.each(partitions.scored, tasks):
        bins[found.numbers] = found.bins
        new += found.new
    others = tuple(sorted({cell for _, cell in new}))
    code = {cell: number for number, cell in enumerate(others)}
    rows = sorted((mission, code[cell]) for mission, cell in new)
    return Scores(
        passed=np.asarray(results["passed"]).astype(bool),
        total=np.asarray(results["total"], np.float64),
        steps=np.asarray(results["steps"]).astype(np.int64),
        time=np.asarray(results["time"], np.float64),
        bins=bins,
        new_mission=np.array([mission for mission, _ in rows], np.int64),
        new_cell=np.array([number for _, number in rows], np.int64),
        others=others,
    )


def transitions(
    database: Database, where: Store, cells: Sequence[Cell], engine: Engine, missions: Ints
) -> partitions.Transitions:
    """Return the transitions of the chosen missions, shape (chosen,)."""
    chosen = np.zeros(database.missions, bool)
    chosen[missions] = True
    wanted = [one.only(chosen[one.numbers]) for one in database.wanted]
    number = partitions.numbered(cells)
    tasks = ((where, some, number) for some in partitions.portions(wanted, PORTION))
    return partitions.sorted_rows([*engine.each(partitions.transitions, tasks)])
