"""Cluster the robots reported as drifted by the similarity of their residual maps.

A residual map has the mean residual of a visit to each cell. The distance of two robots is the largest difference
between their maps in a cell that both visited, in standard errors of the difference. Noise alone therefore does not
separate robots. Complete linkage joins robots as long as no distance within a cluster is significant, with a Bonferroni
correction for the numbers of cells and pairs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import erfc, sqrt

import numpy as np

from pytest_tarl.fleet.changed_robots import Robots
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.database import Database
from pytest_tarl.fleet.residual_maps import ResidualMap, designed, residual_maps
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.tables import Floats
from pytest_tarl.sensors import Cell

# maximum number of robots to compare: those with the most evidence
MOST = 300


@dataclass(frozen=True)
class Cluster:
    """Robots with similar maps, the cells in which they stand out, and the mean residuals."""

    robots: tuple[str, ...]
    cells: tuple[Cell, ...]
    residuals: tuple[float, ...]


@dataclass(frozen=True)
class Clusters:
    """The clusters, largest first; the robots without significant cells; and how many were not compared."""

    found: tuple[Cluster, ...] = ()
    unclear: tuple[str, ...] = ()
    left_out: int = 0
    maps: Mapping[str, ResidualMap] = field(default_factory=dict, compare=False)  # robot → its residual map


def clustered(
    database: Database, where: Store, engine: Engine, fixture: Fixture, robots: Robots, alpha: float
) -> Clusters:
    """Return the clusters of the robots reported as drifted."""
    named = {one.name: one for one in (*robots.below, *robots.drifted)}
    some = sorted(named.values(), key=lambda one: (-max(one.world, one.bound), one.name))
    if not some:
        return Clusters()
    world = designed(fixture)
    maps = residual_maps(database, where, engine, fixture, world, some[:MOST])
    return of(maps, world.variance[:-1], fixture.sample.cells, alpha, len(some) - len(maps))


def of(
    maps: Sequence[ResidualMap], recorded: Floats, cells: Sequence[Cell], alpha: float, left_out: int = 0
) -> Clusters:
    """Return the clusters of robots with these residual maps.

    `recorded`, of shape (cells,), is the variance of the recording's mean residual in each cell.
    """
    # a fixed order, because the order affects the last bits of sums
    ordered = sorted(maps, key=lambda one: one.robot)
    clear = [one for one in ordered if _standing_out(one.mean, one.variance + recorded, alpha).size]
    unclear = tuple(sorted({one.robot for one in maps} - {one.robot for one in clear}))
    groups = _linked(distances(clear), len(cells), alpha) if clear else []
    found = [_cluster([clear[n] for n in group], recorded, cells, alpha) for group in groups]
    found.sort(key=lambda one: (-len(one.robots), one.robots))
    return Clusters(tuple(found), unclear, left_out, {one.robot: one for one in ordered})


def distances(maps: Sequence[ResidualMap]) -> Floats:
    """Return the distance between each pair of maps, shape (maps, maps).

    It is infinite on the diagonal, and for maps without a common cell.
    """
    mean = np.array([one.mean for one in maps])
    variance = np.array([one.variance for one in maps])
    found = np.full((len(maps), len(maps)), np.inf)
    for n in range(len(maps)):
        with np.errstate(divide="ignore", invalid="ignore"):
            apart = np.abs(mean - mean[n]) / np.sqrt(variance + variance[n])
        apart[mean == mean[n]] = 0.0
        known = ~np.isnan(apart).all(axis=1)
        found[n, known] = np.nanmax(apart[known], axis=1)
        found[n, n] = np.inf
    return found


def _linked(distance: Floats, cells: int, alpha: float) -> list[list[int]]:
    """Return clusters by complete linkage, each as a list of rows of `distance`."""
    groups = [[n] for n in range(len(distance))]
    pairs = max(1, len(groups) * (len(groups) - 1) // 2)
    apart = distance.copy()
    while len(groups) > 1:
        one, other = divmod(int(apart.argmin()), len(groups))
        nearest = float(apart[one, other])
        if not _p_value(nearest) * cells * pairs >= alpha:
            break
        one, other = min(one, other), max(one, other)
        joined = np.maximum(apart[one], apart[other])
        joined[one] = np.inf
        apart[one], apart[:, one] = joined, joined
        apart = np.delete(np.delete(apart, other, axis=0), other, axis=1)
        groups[one] += groups.pop(other)
    return groups


def _cluster(maps: Sequence[ResidualMap], recorded: Floats, cells: Sequence[Cell], alpha: float) -> Cluster:
    """Return a cluster of maps; residuals are averaged with weights 1 / variance."""
    mean = np.array([one.mean for one in maps])
    weight = 1.0 / np.maximum(np.array([one.variance for one in maps]), np.finfo(float).tiny)
    weight[np.isnan(mean)] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        pooled = (np.nan_to_num(mean) * weight).sum(axis=0) / weight.sum(axis=0)
        variance = 1.0 / weight.sum(axis=0)
    there = _standing_out(pooled, variance + recorded, alpha)
    return Cluster(
        tuple(sorted(one.robot for one in maps)),
        tuple(cells[n] for n in there.tolist()),
        tuple(pooled[there].tolist()),
    )


def _standing_out(mean: Floats, variance: Floats, alpha: float) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return the cells with a significant mean residual, corrected for the number of cells."""
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.where(mean == 0.0, 0.0, np.abs(mean) / np.sqrt(variance))
    known = ~np.isnan(size)
    p = np.array([_p_value(one) if there else 1.0 for one, there in zip(size, known, strict=True)])
    return np.flatnonzero(p * max(1, int(known.sum())) < alpha)


def _p_value(size: float) -> float:
    """Return the two-sided p-value of a difference given in standard errors (normal distribution)."""
    return erfc(size / sqrt(2.0))
