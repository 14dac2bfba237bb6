"""Build samples of missions for the comparison, from the transitions that workers return."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.database import Columns, Database
from pytest_tarl.fleet.partitions import Transitions, bare, watched_chain
from pytest_tarl.fleet.scores import transitions
from pytest_tarl.learning.tables import Floats, Ints, Sample
from pytest_tarl.sensors import Cell

COLUMNS = "number, mission, passed, total, steps"  # columns to read from the table `missions`
COMPARED = """
    CREATE OR REPLACE TEMP TABLE compared AS
    SELECT number, group_number FROM (
        SELECT number, group_number, row_number() OVER (PARTITION BY group_number ORDER BY mission) AS place
        FROM missions
    ) WHERE place <= ?"""
MISSIONS = f"""
    SELECT group_number, {COLUMNS} FROM missions WHERE number IN (
        SELECT number FROM compared WHERE group_number >= ? AND group_number < ?
    ) ORDER BY group_number, number"""  # noqa: S608 - a constant
PORTION = 100_000  # number of missions read at a time


def groups(
    database: Database, where: Store, engine: Engine, cells: tuple[Cell, ...], count: int, most: int
) -> Iterator[Sample]:
    """Yield at most `most` missions from each of `count` groups.

    It chooses the missions with the smallest IDs. IDs are hashes, so the choice is random.
    """
    database.run(COMPARED, most)
    sizes = database.columns(
        "SELECT count(*) AS size FROM compared GROUP BY group_number ORDER BY group_number"
    )
    ends = np.cumsum(np.asarray(sizes["size"]).astype(np.int64))
    begin = 0
    while begin < count:
        before = int(ends[begin - 1]) if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, before + PORTION, side="right")))
        rows = database.columns(MISSIONS, begin, end)
        numbers = np.asarray(rows["number"]).astype(np.int64)
        found = transitions(database, where, cells, engine, np.sort(numbers))
        for group in range(begin, end):
            low, high = np.searchsorted(rows["group_number"], (group, group + 1)).tolist()
            yield _grouped({name: column[low:high] for name, column in rows.items()}, found, cells)
        begin = end


def _grouped(rows: Columns, every: Transitions, cells: tuple[Cell, ...]) -> Sample:
    numbers = np.asarray(rows["number"]).astype(np.int64)
    total: Floats = np.asarray(rows["total"], np.float64)
    return Sample(
        cells=cells,
        seeds=tuple(int(one) for one in rows["mission"].tolist()),
        passed=np.asarray(rows["passed"]).astype(bool),
        total=total,
        steps=np.asarray(rows["steps"]).astype(np.int64),
        part_names=(),
        chain=every.of(numbers).chain(numbers),
        lists=(),
    )


def following(
    database: Database, where: Store, engine: Engine, cells: Sequence[Cell], spans: Sequence[tuple[int, int]]
) -> Iterator[Sample]:
    """Yield the missions of each span of mission numbers.

    The samples have the cells in `cells`, and one more cell for all others.
    """
    numbers = [np.arange(low, high) for low, high in spans]
    every: Ints = np.unique(np.concatenate([np.empty(0, np.int64), *numbers]))
    found = transitions(database, where, cells, engine, every)
    for low, high in spans:
        rows = database.columns(
            f"SELECT {COLUMNS} FROM missions WHERE number >= ? AND number < ? ORDER BY number",  # noqa: S608 - a constant
            low,
            high,
        )
        chain = watched_chain(found.between(low, high).chain(np.arange(low, high)), len(cells))
        total = np.asarray(rows["total"], np.float64)
        steps = np.asarray(rows["steps"]).astype(np.int64)
        yield bare(len(cells) + 1, np.asarray(rows["passed"]).astype(bool), total, steps, chain)
