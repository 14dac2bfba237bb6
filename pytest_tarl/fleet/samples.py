"""Rows of missions as the sample that the comparison and the watch read."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pytest_tarl.fleet.database import Columns, Database
from pytest_tarl.learning.packing import represented_chain
from pytest_tarl.learning.tables import END, Chain, Floats, Ints, Sample, sum_by
from pytest_tarl.sensors import Cell

COLUMNS = "number, mission, robot, time, passed, total, steps"  # of missions
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
TRANSITIONS = """
    SELECT m.group_number, c.number, c.cell, c.next_cell, c.count, c.reward
    FROM cells AS c JOIN compared AS m ON c.number = m.number
    WHERE m.group_number >= ? AND m.group_number < ? ORDER BY ALL"""
PORTION = 50_000  # missions read together


def groups(database: Database, count: int, most: int) -> Iterator[Sample]:
    """Yield at most `most` missions of each of `count` groups: those with the smallest identities, random digests."""
    database.run(COMPARED, most)
    together = max(1, PORTION // most)
    for begin in range(0, count, together):
        rows = database.columns(MISSIONS, begin, begin + together)
        transitions = database.columns(TRANSITIONS, begin, begin + together)
        for group in range(begin, min(begin + together, count)):
            yield _grouped(_of(group, rows), _of(group, transitions), database.cells)


def _of(group: int, columns: Columns) -> Columns:
    low, high = np.searchsorted(columns["group_number"], (group, group + 1)).tolist()
    return {name: column[low:high] for name, column in columns.items()}


def _grouped(rows: Columns, transitions: Columns, cells: tuple[Cell, ...]) -> Sample:
    numbers = np.asarray(rows["number"]).astype(np.int64)
    episode: Ints = np.asarray(np.searchsorted(numbers, transitions["number"]), np.int64)
    return _sample(rows, _chain(episode, transitions), cells)


def following(database: Database, first: int, end: int) -> tuple[Columns, Columns]:
    """Return the rows of the missions `first` to `end` - 1 and of their transitions, in order."""
    rows = database.columns(
        f"SELECT {COLUMNS} FROM missions WHERE number >= ? AND number < ? ORDER BY number",  # noqa: S608 - a constant
        first,
        end,
    )
    return rows, database.columns(
        "SELECT * FROM cells WHERE number >= ? AND number < ? ORDER BY ALL", first, end
    )


def watched(rows: Columns, transitions: Columns, recorded: int) -> Sample:
    """Return missions over the cells of a recording and one more for all others, rounded as in a recording."""
    numbers = rows["number"].astype(np.int64)
    episode: Ints = np.asarray(np.searchsorted(numbers, transitions["number"]), np.int64)
    chain = represented_chain(_without_others(_chain(episode, transitions), recorded))
    return _sample(rows, chain, ((),) * (recorded + 1))


def _without_others(chain: Chain, recorded: int) -> Chain:
    """Give all cells that the recording lacks one number, and join the transitions that become equal."""
    width = recorded + 1
    cell, after = np.minimum(chain.cell, recorded), np.minimum(chain.next_cell, recorded)
    if not max(chain.cell.max(initial=0), chain.next_cell.max(initial=0)) >= recorded:
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


def _chain(episode: Ints, transitions: Columns) -> Chain:
    cell, after, count = (
        np.asarray(transitions[name]).astype(np.int64) for name in ("cell", "next_cell", "count")
    )
    reward = np.asarray(transitions["reward"], np.float64)
    return Chain(
        episode.astype(np.int64),
        cell,
        np.where(after < 0, END, after),
        count,
        reward,
        np.zeros((cell.size, 0)),
    )


def _sample(rows: Columns, chain: Chain, cells: tuple[Cell, ...]) -> Sample:
    total: Floats = np.asarray(rows["total"], np.float64)
    steps: Ints = np.asarray(rows["steps"]).astype(np.int64)
    return Sample(
        cells=cells,
        seeds=tuple(int(one) for one in rows["mission"].tolist()),
        passed=np.asarray(rows["passed"]).astype(bool),
        total=total,
        steps=steps,
        part_names=(),
        chain=chain,
        lists=(),
    )


def part(sample: Sample, begin: int, end: int) -> Sample:
    """Return the missions `begin` to `end` - 1 of a sample whose rows are sorted by mission."""
    first, last = np.searchsorted(sample.chain.episode, (begin, end)).tolist()
    columns = {name: column[first:last] for name, column in vars(sample.chain).items()}
    return Sample(
        cells=sample.cells,
        seeds=sample.seeds[begin:end],
        passed=sample.passed[begin:end],
        total=sample.total[begin:end],
        steps=sample.steps[begin:end],
        part_names=(),
        chain=Chain(**columns | {"episode": columns["episode"] - begin}),
        lists=(),
    )
