"""Compute a robot's residual map: how much more or less than recorded a visit to each cell earns.

The residual of a visit is the Bellman residual of the recorded utility (learning/residuals.py). It therefore shows the
cells in which the world changed, and not the cells visited before them. Each value has a variance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytest_tarl.fleet.changed_robots import Robot, lower
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.data_folder import Store
from pytest_tarl.fleet.database import Database
from pytest_tarl.fleet.samples import following
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.residuals import Model, fitted, residuals
from pytest_tarl.learning.tables import Floats, Sample, sum_by

FEWEST = 5  # minimum number of missions in a cell for a residual


@dataclass(frozen=True)
class ResidualMap:
    """Mean and variance of the residual per cell; NaN if there are too few missions."""

    robot: str
    mean: Floats
    variance: Floats


@dataclass(frozen=True)
class Designed:
    """The model of the recording, with the residual variance per cell and per visit."""

    model: Model
    variance: Floats
    of_visit: Floats


def designed(fixture: Fixture) -> Designed:
    """Return the model of a recording, with a single cell for all unrecorded cells."""
    cells = len(fixture.sample.cells) + 1
    model = fitted(fixture.sample.chain, cells)
    own = Sample(**{**vars(fixture.sample), "cells": ((),) * cells, "lists": ()})
    _, variance, visits = _mean(own, model)
    return Designed(model, variance, variance * visits)


def residual_maps(
    database: Database,
    where: Store,
    engine: Engine,
    fixture: Fixture,
    world: Designed,
    robots: Sequence[Robot],
) -> list[ResidualMap]:
    """Return each robot's residual map over its missions since the onset of its difference.

    A robot with few missions may have similar residuals by chance, which makes their variance too small. The variance
    of a map is therefore at least that of the same number of recorded visits.
    """
    query = "SELECT min(number) AS first, max(number) + 1 AS ends FROM missions WHERE robot = ?"
    spans = []
    for robot in robots:
        found = database.columns(query, robot.name)
        first, end = int(found["first"][0]), int(found["ends"][0])
        spans.append((min(first + since(robot), end - 1), end))
    every = following(database, where, engine, fixture.sample.cells, spans)
    return [_map(robot.name, sample, world) for robot, sample in zip(robots, every, strict=True)]


def _map(name: str, sample: Sample, world: Designed) -> ResidualMap:
    mean, variance, visits = _mean(sample, world.model)
    with np.errstate(divide="ignore", invalid="ignore"):
        least = world.of_visit / visits
    return ResidualMap(name, mean[:-1], np.fmax(variance, least)[:-1])


def since(robot: Robot) -> int:
    """Return the number of missions before the onset; 0 if the onset is unknown."""
    if robot.status is None:
        return 0
    below = lower(robot.status)
    evidence = below if below is not None and robot.bound >= robot.world else robot.status.world
    return 0 if evidence.since is None else evidence.since.mission - 1


def _mean(sample: Sample, model: Model) -> tuple[Floats, Floats, Floats]:
    """Return the mean residual, its variance and the visits per cell, for independent missions."""
    found = residuals(sample, model)
    total = found.move + found.reward
    place = sample.chain.episode * total.shape[1] + sample.chain.cell
    visits = sum_by(place, sample.chain.count, total.size).reshape(total.shape)
    count, missions = visits.sum(axis=0), (visits > 0).sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = total.sum(axis=0) / count
        spread = ((total - np.where(visits > 0, mean, 0.0) * visits) ** 2).sum(axis=0)
        variance = spread / count**2 * missions / (missions - 1)
    known = missions >= FEWEST
    return np.where(known, mean, np.nan), np.where(known, variance, np.nan), count
