"""Score new missions, for comparison with the scores of held-out recorded missions.

The model is fitted to one half of the recorded episodes; the scores of the other half are the initial pools. New
missions are rounded as in a recording, so that their scores are exchangeable with the recorded ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.errors import FixtureError
from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.packing import represented_chain
from pytest_tarl.learning.residuals import Model, fitted, in_fit, residuals
from pytest_tarl.learning.statistics import summed, total_rewards
from pytest_tarl.learning.tables import END, Chain, Floats, Ints, Sample, sum_by
from pytest_tarl.learning.tiles import tiled
from pytest_tarl.monitoring.conformal import BINS, edges
from pytest_tarl.sensors import Cell

# the scores of a whole mission; the scores of its cells follow
WHOLE = ("success", "total", "residual", "unknown", "steps")
FEWEST = 2  # minimum number of episodes in each half of a recording


@dataclass(frozen=True)
class Missions:
    """Missions in order; the columns of steps have shape (steps,).

    `cell` is the row of a step's cell in the scale's table of cells. It is the number of rows for a cell that is not in
    the table, and -1 as long as some sensor has no value. A mission may have no steps.
    """

    passed: NDArray[np.bool_]
    time: Floats  # start of each mission in seconds since 1970, shape (missions,)
    mission: Ints  # index of each step's mission
    cell: Ints
    reward: Floats
    new: tuple[Cell, ...] = ()  # cells that the scale lacks, once for each mission that visited them

    @property
    def count(self) -> int:
        """Return the number of missions."""
        return len(self.passed)


@dataclass(frozen=True)
class Scale:
    """The fitted model, its cells, and the bin edges of shape (scores, BINS - 1)."""

    cells: tuple[Cell, ...]
    # whether the model was fitted for each cell; the last entry (False) is for all other cells
    known: NDArray[np.bool_]
    model: Model
    edges: Floats

    @property
    def number(self) -> Mapping[Cell, int]:
        """Return the row of each cell in the table of cells."""
        return {cell: row for row, cell in enumerate(self.cells)}


def scale(fixture: Fixture) -> tuple[Scale, Ints]:
    """Return the scale, and the bins of the held-out episodes, shape (episodes, scores).

    Raise FixtureError if one half of the recording has too few episodes.
    """
    sample = fixture.sample
    fit = np.array([in_fit(seed) for seed in sample.seeds])
    if min(fit.sum(), (~fit).sum()) < FEWEST:
        raise FixtureError(
            f"The recording of {fixture.test} has {sample.episodes} episodes: too few to fit on one half and compare "
            "with the other. Record more with --tarl-episodes."
        )
    rows = fit[sample.chain.episode]
    chain = Chain(*(column[rows] for column in vars(sample.chain).values()))
    count = len(sample.cells)
    model = fitted(chain, count, tiled(sample.cells, fixture.sensors))
    model = Model(*(np.append(getattr(model, one.name), np.nan) for one in fields(Model)))
    bare = Scale(sample.cells, ~np.isnan(model.utility), model, np.empty((0, BINS - 1)))
    wide = replace(
        sample, cells=(*sample.cells, ())
    )  # sums are rounded as for new missions, whose layout has this additional cell
    values = _values(bare, wide)
    units = _units(chain, int(fit.sum()), count)
    found = [
        edges(column[fit & ~np.isnan(column)], unit) for column, unit in zip(values.T, units, strict=True)
    ]
    whole = Scale(sample.cells, bare.known, model, np.array(found))
    return whole, _binned(whole, values[~fit])


def binned(scale: Scale, sample: Sample) -> Ints:
    """Return the bin of every score of every mission, shape (missions, scores); -1 for a missing score.

    A mission without steps has only a score for its success. A mission without rewards lacks all scores that need
    rewards.
    """
    return _binned(scale, _values(scale, sample))


def _binned(scale: Scale, values: Floats) -> Ints:
    found = np.full(values.shape, -1, np.int64)
    for column in np.flatnonzero(~np.isnan(values).all(axis=0)).tolist():
        found[:, column] = scale.edges[column].searchsorted(values[:, column], side="right")
    found[np.isnan(values)] = -1
    return found


def _values(scale: Scale, sample: Sample) -> Floats:
    """Return the scores, shape (missions, scores); NaN for a missing score.

    The score of a cell is its mean residual per visit.
    """
    parts = residuals(sample, scale.model)
    residual = parts.move + parts.reward
    chain, count = sample.chain, len(scale.cells)
    width = len(scale.known)
    visits = sum_by(chain.episode * width + chain.cell, chain.count, sample.episodes * width)
    visits = visits.reshape(-1, width)
    inside = np.where(scale.known & (visits > 0), visits, np.nan)[:, :count]
    moved = np.where(sample.steps > 0, 0.0, np.nan)
    judged = moved + np.where(np.isfinite(sample.total), 0.0, np.nan)
    with np.errstate(invalid="ignore"):
        whole = [
            sample.passed.astype(np.float64),
            sample.total + judged,
            residual.sum(axis=1) + judged,
            visits[:, ~scale.known].sum(axis=1) + moved,
            sample.steps + moved,
        ]
    cells = residual[:, :count] / inside + judged[:, None]
    return np.concatenate([np.stack(whole, axis=1), cells], axis=1)


def _units(chain: Chain, episodes: int, cells: int) -> Floats:
    """Return the magnitude of the terms that each score sums, shape (scores,).

    A score's rounding errors are proportional to it.
    """
    size = float(np.abs(chain.reward).sum())
    mission, step = size / max(1, episodes), size / max(1, int(chain.count.sum()))
    whole = {"success": 1.0, "total": mission, "residual": mission, "unknown": 1.0, "steps": 1.0}
    return np.array([*(whole[name] for name in WHOLE), *([step] * cells)])


def sampled(scale: Scale, missions: Missions) -> Sample:
    """Return missions in the form of recorded episodes, with one additional cell for all cells that the scale lacks.

    A mission's total is NaN if it has no steps or an unknown reward.
    """
    known = missions.cell >= 0
    reward = np.where(np.isfinite(missions.reward), missions.reward, 0.0)[known]
    width = len(scale.known)
    return Sample(
        cells=((),) * width,
        seeds=tuple(range(missions.count)),
        passed=missions.passed,
        total=_totals(missions),
        steps=np.bincount(missions.mission, minlength=missions.count),
        part_names=(),
        chain=_chain(missions.mission[known], missions.cell[known], reward, width),
        lists=(),
    )


def _totals(missions: Missions) -> Floats:
    ends = np.searchsorted(missions.mission, np.arange(missions.count + 1))
    size = sum_by(missions.mission, np.abs(missions.reward), missions.count)
    total = total_rewards(missions.reward, ends)
    return np.where((np.diff(ends) > 0) & np.isfinite(size), total, np.nan)


def _chain(mission: Ints, cell: Ints, reward: Floats, width: int) -> Chain:
    """Return the transitions between consecutive steps, with sums rounded as in a recording."""
    following = np.append(cell[1:], END)
    following[np.flatnonzero(np.diff(mission))] = END
    codes, place, count = np.unique(
        (mission * width + cell) * (width + 1) + following + 1, return_inverse=True, return_counts=True
    )
    chain = Chain(
        episode=codes // (width + 1) // width,
        cell=codes // (width + 1) % width,
        next_cell=codes % (width + 1) - 1,
        count=count.astype(np.int64),
        reward=summed(place, reward, codes.size),
        parts=np.zeros((codes.size, 0)),
    )
    return represented_chain(chain)
