"""Which groups live in another world than recorded, and since when: the evidence of `tarl watch`, group by group.

All missions of a group, of all its robots, go through one monitor in the order of their times. A change that is too
small or too short to be seen in one robot, such as a season at a site, is seen in all of them together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from pytest_tarl.fleet import robots
from pytest_tarl.fleet.database import Columns, Database
from pytest_tarl.fleet.engine import Engine
from pytest_tarl.fleet.groups import Group
from pytest_tarl.fleet.robots import PORTION, Robot, Robots, fresh, new_cells, portions
from pytest_tarl.fleet.samples import COLUMNS, watched
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.tables import Ints
from pytest_tarl.monitoring.monitor import Monitor, begun

MOST = 2 * PORTION  # missions of groups that are judged side by side
NUMBERED = """
    CREATE OR REPLACE TEMP TABLE in_time AS
    SELECT number, CAST(row_number() OVER (ORDER BY group_number, time, mission) - 1 AS INTEGER) AS place
    FROM missions"""
MISSIONS = f"""
    SELECT * EXCLUDE (place) REPLACE (place AS number)
    FROM (SELECT {COLUMNS}, place FROM missions JOIN in_time USING (number)) WHERE place >= ? AND place < ?
    ORDER BY place"""  # noqa: S608 - a constant
TRANSITIONS = """
    SELECT t.place AS number, c.cell, c.next_cell, c.count, c.reward
    FROM cells AS c JOIN in_time AS t ON c.number = t.number WHERE t.place >= ? AND t.place < ? ORDER BY ALL"""


def judged(
    database: Database,
    fixture: Fixture,
    engine: Engine,
    groups: Sequence[Group],
    q: float,
    seed: int = 0,
) -> Robots:
    """Return the evidence on each group, in their order, and those that e-BH names at the false discovery rate `q`."""
    first = begun(fixture, alpha=q, seed=seed)
    database.run(NUMBERED)
    some = list(portions(np.cumsum([group.missions for group in groups])))
    begins = [0, *(int(ends[-1]) for ends in some)]
    small = [int(ends[-1]) - begin <= MOST for begin, ends in zip(begins, some, strict=False)]
    tasks = (
        (
            first,
            *_rows(database, begin, int(ends[-1])),
            ends - begin,
            database.cells[len(first.scale.cells) :],
            q,
        )
        for begin, ends, together in zip(begins, some, small, strict=False)
        if together
    )
    judged_together = engine.each(robots.portioned, tasks)
    every = [
        one
        for begin, ends, together in zip(begins, some, small, strict=False)
        for one in (next(judged_together) if together else _one_by_one(database, first, begin, ends, q))
    ]
    names = [" ".join(group.values) for group in groups]
    return robots.named(tuple(replace(one, name=name) for one, name in zip(every, names, strict=True)), q)


def _rows(database: Database, begin: int, end: int) -> tuple[Columns, Columns]:
    return database.columns(MISSIONS, begin, end), database.columns(TRANSITIONS, begin, end)


def _one_by_one(database: Database, first: Monitor, begin: int, ends: Ints, q: float) -> Iterator[Robot]:
    """Judge groups of many missions in portions, so that the rows of a group need not fit into memory."""
    recorded = len(first.scale.cells)
    for end in ends.tolist():
        monitor = fresh(first)
        for low in range(begin, end, PORTION):
            high = min(low + PORTION, end)
            rows, transitions = _rows(database, low, high)
            new = new_cells(database.cells[recorded:], transitions, low, high - low, recorded)
            monitor.take(watched(rows, transitions, recorded), np.asarray(rows["time"], np.float64), new)
        begin = end
        yield robots.robot("", monitor, q)
