"""Decompose the variance of a fleet's missions by versions, sites, seasons and robots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pytest_tarl.fleet.components import Component, Totals, components
from pytest_tarl.fleet.database import BY, Database
from pytest_tarl.learning.tables import Floats, Ints, sum_by
from pytest_tarl.seeds import generator

CONFIDENCE = 0.95
PORTION = 200_000  # number of missions read at a time
MONTHS = 3  # seasons are months if there are at least this many, and weeks otherwise

CODES = """
    CREATE OR REPLACE TEMP TABLE of_{name} AS
    SELECT name, CAST(row_number() OVER (ORDER BY name) - 1 AS INTEGER) AS code
    FROM (SELECT DISTINCT {column} AS name FROM missions)"""
NAMES = "SELECT name FROM of_{name} ORDER BY code"
COUNT = "SELECT count(DISTINCT {column}) FROM missions"
MISSIONS = """
    SELECT m.robot_number, m.total, {codes}
    FROM (SELECT * FROM missions WHERE number >= ? AND number < ?) AS m {joins} ORDER BY m.number"""


@dataclass(frozen=True)
class Decomposition:
    """The variance components of the missions' rewards; `season` is "month" or "week"."""

    season: str
    components: tuple[Component, ...]
    levels: tuple[
        tuple[str, ...], ...
    ]  # names of the levels of each factor: version, site, season, and repair if any robot has one
    confidence: float = CONFIDENCE

    @property
    def total(self) -> float:
        """Return the sum of all components that are known and positive."""
        return sum(max(0.0, one.variance) for one in self.components if one.variance == one.variance)


def decomposed(database: Database, seed: int = 0) -> Decomposition:
    """Return the decomposition for the selected missions."""
    season = "month" if _count(database, BY["month"]) >= MONTHS else "week"
    factors = {"version": BY["version"], "site": BY["site"], "season": BY[season]}
    if _count(database, BY["repair"]) > 1:
        factors["repair"] = BY["repair"]
    levels = []
    for name, column in factors.items():
        database.run(CODES.format(name=name, column=column))
        levels.append(tuple(str(one) for (one,) in database.names(NAMES.format(name=name))))
    totals = _totals(database, factors, tuple(map(len, levels)))
    found = components(totals, tuple(factors), CONFIDENCE, generator(seed, "fleet/components"))
    return Decomposition(season, found, tuple(levels))


def _count(database: Database, column: str) -> int:
    return int(database.names(COUNT.format(column=column))[0][0])


def _totals(database: Database, factors: dict[str, str], sizes: tuple[int, ...]) -> Totals:
    """Return the sums of rewards minus their mean, so that squares keep their precision."""
    joins = " ".join(f"JOIN of_{name} ON of_{name}.name = {column}" for name, column in factors.items())
    codes = ", ".join(f"of_{name}.code AS {name}_code" for name in factors)
    query = MISSIONS.format(codes=codes, joins=joins)
    missions = database.missions
    portions = [database.columns(query, begin, begin + PORTION) for begin in range(0, missions, PORTION)]

    def joined(name: str) -> Ints:
        return np.concatenate([np.asarray(one[name]).astype(np.int64) for one in portions])

    total: Floats = np.concatenate([np.asarray(one["total"], np.float64) for one in portions])
    robot = joined("robot_number")
    levels = np.stack([joined(f"{name}_code") for name in factors], axis=1)
    return summed(robot, levels, total - total.mean(), sizes)


def summed(robot: Ints, levels: Ints, reward: Floats, sizes: tuple[int, ...]) -> Totals:
    """Return the sums for each robot and combination of levels; the arrays have one row per mission."""
    key = np.ravel_multi_index((robot, *levels.T), (int(robot.max()) + 1, *sizes))
    _, first, row = np.unique(key, return_index=True, return_inverse=True)
    return Totals(
        robot=robot[first],
        levels=levels[first],
        count=np.bincount(row).astype(np.float64),
        reward=sum_by(row, reward, first.size),
        squares=sum_by(robot, reward**2, int(robot.max()) + 1),
        sizes=sizes,
    )
