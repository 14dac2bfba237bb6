"""Estimate the effect of each repair per group, compared with missions without a repair.

During a staged roll-out, missions run with and without the repair at the same time. Missions are compared only within a
stratum (the same group, site and week), so differences between seasons or sites do not count as an effect
(stratification; Cochran 1968, Biometrics 24:295-313). The effect is the weighted mean of the strata's differences, with
the weights n₁n₀/(n₁ + n₀), which minimise its variance. Missions of one robot are alike, so the interval comes from
Tukey's jackknife over robots (Miller 1974, Biometrika 61:1-15) with Student's t.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isinf

import numpy as np

from pytest_tarl.fleet.database import BY, Database
from pytest_tarl.learning.bounds import mean_of
from pytest_tarl.learning.tables import Floats, Ints, sum_by
from pytest_tarl.model import Bound

FEWEST = 4  # minimum number of robots with and without the repair, for an interval
ALPHA = 0.05  # probability that any interval of a repair is wrong
OUTCOMES = ("total", "passed")


@dataclass(frozen=True)
class Effect:
    """The effect of a repair in a group; `reward` and `success` are differences per mission.

    Both are NaN if no stratum has missions with and without the repair. `missions` and `robots` count only strata that
    have both.
    """

    repair: str
    values: tuple[str, ...]
    missions: tuple[int, int]
    robots: tuple[int, int]
    strata: int
    reward: float
    reward_bound: Bound
    success: float
    success_bound: Bound

    @property
    def verdict(self) -> str:
        """Return whether the repair helps, according to the interval of the reward."""
        if not self.strata:
            return "not comparable"
        if isinf(self.reward_bound.low):
            return "too few robots"
        if self.reward_bound.low > 0:
            return "helps"
        return "harms" if self.reward_bound.high < 0 else "no effect shown"


@dataclass(frozen=True)
class Strata:
    """Missions and sums of rewards by robot and stratum (rows), without and with the repair (columns)."""

    robot: Ints
    stratum: Ints
    count: Floats
    total: Floats
    passed: Floats


def effects(database: Database, by: Sequence[str]) -> tuple[Effect, ...]:
    """Return the effect of each repair in each group; groups are formed by the columns `by`."""
    columns = tuple(one for one in by if one != "repair")
    repairs = [
        one for (one,) in database.names("SELECT DISTINCT repair FROM missions WHERE repair <> '' ORDER BY 1")
    ]
    some = [(repair, values) for repair in repairs for values in _groups(database, repair, columns)]
    confidence = 1.0 - ALPHA / 2 / max(1, len(some))
    return tuple(
        effect(repair, values, _strata(database, repair, columns, values), confidence)
        for repair, values in some
    )


def _groups(database: Database, repair: str, columns: Sequence[str]) -> Iterator[tuple[str, ...]]:
    chosen = ", ".join(f"CAST({BY[one]} AS VARCHAR)" for one in columns) or "1"
    found = database.columns(f"SELECT DISTINCT {chosen} FROM missions WHERE repair = ? ORDER BY ALL", repair)  # noqa: S608 - from BY
    rows = zip(*(column.tolist() for column in found.values()), strict=True)
    yield from (tuple(map(str, row)) if columns else () for row in rows)


def _strata(database: Database, repair: str, columns: Sequence[str], values: Sequence[str]) -> Strata:
    """Return the rows of the strata, summed in mission order."""
    here = "".join(f" AND CAST({BY[one]} AS VARCHAR) = ?" for one in columns)
    found = database.columns(
        f"SELECT robot_number, dense_rank() OVER (ORDER BY site, {BY['week']}) - 1 AS stratum, repair = ? AS treated, "  # noqa: S608
        f"total, passed FROM missions WHERE repair IN ('', ?){here} ORDER BY number",
        repair,
        repair,
        *values,
    )
    return strata(
        *(np.asarray(found[name]) for name in ("robot_number", "stratum", "treated", "total", "passed"))
    )


def strata(robot: Ints, stratum: Ints, treated: Ints, total: Floats, passed: Ints) -> Strata:
    """Return one row per robot and stratum, for strata with missions of both kinds."""
    stratum, treated = stratum.astype(np.int64), treated.astype(np.int64)
    both = np.bincount(stratum * 2 + treated, minlength=2 * (int(stratum.max(initial=0)) + 1)).reshape(-1, 2)
    there = both.min(axis=1)[stratum] > 0
    pairs = np.stack([robot.astype(np.int64), stratum], axis=1)[there]
    distinct, row = np.unique(pairs, axis=0, return_inverse=True)
    place, size = row.ravel() * 2 + treated[there], 2 * len(distinct)
    sums = [
        sum_by(place, weight[there].astype(np.float64), size).reshape(-1, 2)
        for weight in (np.ones(len(robot)), total, passed)
    ]
    return Strata(distinct[:, 0], np.unique(distinct[:, 1], return_inverse=True)[1].ravel(), *sums)


def effect(repair: str, values: tuple[str, ...], rows: Strata, confidence: float) -> Effect:
    """Return the effect over the strata, with one-sided bounds at the given confidence."""
    counts = rows.count.sum(axis=0).astype(int).tolist() if len(rows.robot) else [0, 0]
    robots = [len(set(rows.robot[rows.count[:, arm] > 0].tolist())) for arm in (0, 1)]
    (reward, reward_bound), (success, success_bound) = (
        _estimated(rows, getattr(rows, name), min(robots), confidence) for name in OUTCOMES
    )
    return Effect(
        repair=repair,
        values=values,
        missions=(counts[1], counts[0]),
        robots=(robots[1], robots[0]),
        strata=len(set(rows.stratum.tolist())),
        reward=reward,
        reward_bound=reward_bound,
        success=success,
        success_bound=success_bound,
    )


def _estimated(rows: Strata, sums: Floats, fewest: int, confidence: float) -> tuple[float, Bound]:
    """Return the difference, with bounds from the jackknife over robots."""
    if not len(rows.robot):
        return float("nan"), mean_of((), confidence)
    number = int(rows.stratum.max()) + 1
    count, total = (
        np.stack([sum_by(rows.stratum, column[:, arm], number) for arm in (0, 1)], axis=1)
        for column in (rows.count, sums)
    )
    weight, weighted = _difference(count, total)
    whole = float(weighted.sum() / weight.sum())
    less, less_weighted = _difference(count[rows.stratum] - rows.count, total[rows.stratum] - sums)
    _, robot = np.unique(rows.robot, return_inverse=True)
    robots = int(robot.max()) + 1
    lost = sum_by(robot, weight[rows.stratum] - less, robots)
    lost_weighted = sum_by(robot, weighted[rows.stratum] - less_weighted, robots)
    remaining = weight.sum() - lost
    if fewest < FEWEST or not np.all(remaining > 0):
        return whole, mean_of((), confidence)
    without = (weighted.sum() - lost_weighted) / remaining
    pseudo = robots * whole - (robots - 1) * without
    found = mean_of(pseudo.tolist(), confidence)
    return whole, Bound(found.low, found.high, confidence, "jackknife", False, found.episodes)


def _difference(count: Floats, total: Floats) -> tuple[Floats, Floats]:
    """Return the weight and the weighted difference of each row; 0 unless it has missions of both kinds."""
    both = count.min(axis=1) > 0.5
    safe = np.where(both[:, None], count, 1.0)
    weight = np.where(both, safe[:, 0] * safe[:, 1] / safe.sum(axis=1), 0.0)
    return weight, weight * (total[:, 1] / safe[:, 1] - total[:, 0] / safe[:, 0])
