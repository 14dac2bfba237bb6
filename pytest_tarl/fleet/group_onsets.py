"""Which groups live in another world than recorded, and since when: the evidence of `tarl watch`, group by group.

All missions of a group, of all its robots, go through one monitor in the order of their times. A change that is too
small or too short to be seen in one robot, such as a season at a site, is seen in all of them together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.fleet import robots
from pytest_tarl.fleet.database import Columns, Database
from pytest_tarl.fleet.groups import Group
from pytest_tarl.fleet.robots import PORTION, Robots, fresh, new_cells
from pytest_tarl.fleet.samples import watched
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.monitoring.monitor import Monitor, begun

NUMBERED = """
    CREATE OR REPLACE TEMP TABLE in_time AS
    SELECT number, CAST(row_number() OVER (ORDER BY time, mission) - 1 AS INTEGER) AS place
    FROM missions WHERE group_number = ?"""
MISSIONS = """
    SELECT m.* EXCLUDE (number), t.place AS number
    FROM missions AS m JOIN in_time AS t ON m.number = t.number WHERE t.place >= ? AND t.place < ? ORDER BY t.place"""
TRANSITIONS = """
    SELECT t.place AS number, c.cell, c.next_cell, c.count, c.reward
    FROM cells AS c JOIN in_time AS t ON c.number = t.number WHERE t.place >= ? AND t.place < ? ORDER BY ALL"""


def judged(database: Database, fixture: Fixture, groups: Sequence[Group], q: float, seed: int = 0) -> Robots:
    """Return the evidence on each group, in their order, and those that e-BH names at the false discovery rate `q`."""
    first = begun(fixture, alpha=q, seed=seed)
    every = []
    for number, group in enumerate(groups):
        monitor = fresh(first)
        _watch(database, monitor, number, group.missions, len(fixture.sample.cells))
        every.append(robots.robot(" ".join(group.values), monitor, q))
    return robots.named(tuple(every), q)


def _watch(database: Database, monitor: Monitor, group: int, missions: int, recorded: int) -> None:
    database.run(NUMBERED, group)
    for begin in range(0, missions, PORTION):
        rows: Columns = database.columns(MISSIONS, begin, begin + PORTION)
        transitions = database.columns(TRANSITIONS, begin, begin + PORTION)
        new = new_cells(database.cells[recorded:], transitions, begin, PORTION, recorded)
        monitor.take(watched(rows, transitions, recorded), np.asarray(rows["time"], np.float64), new)
