"""Find the groups whose world differs from the recorded one, and when the difference began.

One monitor per group judges the missions of all its robots in order of time, as in `tarl watch`. Some changes, such as
a season at a site, are too small or too short to show in a single robot, but show in all robots of the group together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytest_tarl.fleet import changed_robots
from pytest_tarl.fleet.changed_robots import Robots
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.database import Database
from pytest_tarl.fleet.mission_groups import Group
from pytest_tarl.fleet.scores import Scores
from pytest_tarl.monitoring.monitor import Monitor

IN_TIME = "SELECT number FROM missions ORDER BY group_number, time, mission"


def judged(
    database: Database, first: Monitor, scores: Scores, engine: Engine, groups: Sequence[Group], q: float
) -> Robots:
    """Return the evidence on groups, and those reported at the false discovery rate `q`."""
    order = np.asarray(database.columns(IN_TIME)["number"]).astype(np.int64)
    ends = np.cumsum([group.missions for group in groups])
    names = [" ".join(group.values) for group in groups]
    found = changed_robots.watched(first, scores.ordered(order), names, ends, engine, q)
    return changed_robots.named(tuple(found), q)
