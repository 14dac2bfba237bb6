"""Small answers of `tarl fleet`, written down by hand, for the tests of its text, page and document."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from pytest_tarl.fleet.changed_robots import Robot, Robots
from pytest_tarl.fleet.clusters import Clusters
from pytest_tarl.fleet.mission_groups import Group
from pytest_tarl.fleet.question import Answer, Question
from pytest_tarl.fleet.repairs import Effect
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.merging import merge
from pytest_tarl.learning.statistics import sample
from pytest_tarl.model import Bound, Region, Verdict
from pytest_tarl.monitoring import stated
from pytest_tarl.monitoring.status import Evidence, Moment, Status
from pytest_tarl.sensors import Cell
from tests.plugin.monitoring import missions

DAY = 86_400.0
CELLS: tuple[Cell, ...] = tuple((x, wet) for x in range(4) for wet in range(2))


def bound(low: float, high: float, exact: bool = True) -> Bound:
    return Bound(low, high, 0.95, "test", exact, 10)


def evidence(highest: float, mission: int | None = None, time: float | None = None) -> Evidence:
    """Return evidence with an onset at the mission, or without an onset."""
    return Evidence(0.0, highest, None if mission is None else Moment(mission, time), None)


def status(world: Evidence, cells: tuple[Cell, ...] = (), *bounds: Evidence | None) -> Status:
    """Return the status with the evidence on the world and against each bound."""
    told = tuple((stated.Bound("success", 0.9, 0.95), one) for one in bounds)
    return Status(10, 9, 0.05, told, world, None, cells, ())


def robot(name: str, world: float = -1.0, bound: float = -1.0, status: Status | None = None) -> Robot:
    return Robot(name, 10, 9, world, bound, status)


def robots(*every: Robot, drifted: tuple[Robot, ...] = (), below: tuple[Robot, ...] = ()) -> Robots:
    return Robots(0.1, every, drifted, below)


def group(*values: str, result: Any = None, cells: tuple[Cell, ...] = (), **changes: Any) -> Group:
    """Return a group of 40 missions, 30 of which passed; its verdict has a loss of 1.5 at p 0.004 and 0.03."""
    verdict = None if result is None else Verdict(result, 0.03, 0.004, 1.5, 0.2, 0.1)
    one = Group(
        values, 40, 4, 30, 2.5, bound(0.6, 0.85), bound(2.25, 2.75, False), 0, 40, verdict, Region(cells)
    )
    return replace(one, **changes)


def effect(repair: str = "guard-1", reward: float = 0.5, low: float = 0.25, **changes: Any) -> Effect:
    """Return an effect with bounds `low` and 0.75 of the reward, and 0.01 and 0.09 of the success."""
    one = Effect(repair, (), (1200, 2400), (12, 24), 3, reward, bound(low, 0.75), 0.05, bound(0.01, 0.09))
    return replace(one, **changes)


def unknown(repair: str = "guard-1") -> Effect:
    """Return the effect of a repair if no stratum has missions both with and without the repair."""
    nothing = bound(-inf, inf)
    return Effect(repair, (), (0, 0), (0, 0), 0, float("nan"), nothing, float("nan"), nothing)


def fixture() -> Fixture:
    """Return the recording of ten missions."""
    walks = missions.walks(10, 1)
    whole = merge([sample(missions.trace(one), n, one.passed, ()) for n, one in enumerate(walks)])
    return Fixture(missions.TEST, 0, missions.SENSORS, (), {}, whole, ())


def answer(**changes: Any) -> Answer:
    """Return the answer for one group of one robot, without a difference."""
    plain = robots(robot("r1"))
    one = Answer(
        question=Question("data", by=("site",)),
        fixture=fixture(),
        missions=40,
        copies=0,
        cells=CELLS,
        groups=(group("north"),),
        onsets=robots(robot("north")),
        robots=plain,
        parts=None,
        clusters=Clusters(),
        repairs=(),
        left_out={},
    )
    return replace(one, **changes)


def mean_of_recording() -> float:
    return float(np.mean([sum(one.reward) for one in missions.walks(10, 1)]))
