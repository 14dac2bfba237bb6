"""Compare two worlds: is performance worse, is the world another one, and in which cells?

The Bellman residuals of the off-line utility are zero in expectation where the world still is the one that it was
fitted in, so what stands out is where it changed, not what lies upstream of it (performance-difference lemma,
Kakade & Langford 2002). Significance is by permutation of whole episodes, corrected over cells by the largest
statistic (Westfall & Young 1993).
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from math import comb, inf
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.merging import aligned
from pytest_tarl.learning.tables import END, Chain, Floats, Ints, Sample, sum_by
from pytest_tarl.learning.utility import GAMMA_STEP, chain_utility
from pytest_tarl.model import Region, Result, Verdict
from pytest_tarl.sensors import Cell

PERMUTATIONS = 999
POWER = 0.8  # of the smallest loss that is called detectable
MATERIAL = 0.1  # a cell belongs to the region from this share of the largest significant difference
NOVEL_VISITS = 3  # a cell unknown to the fit counts as novel from so many visits,
NOVEL_EPISODES = 2  # in so many episodes


@dataclass(frozen=True)
class Residuals:
    """Per episode and cell, shape (episodes, cells): the two parts of the Bellman residual, visits to novel cells."""

    move: Floats
    reward: Floats
    novel: Floats


@dataclass(frozen=True)
class Difference:
    """What the comparison of two samples found, before any word of it.

    `changes` tells by cell how far an on-line episode is from an off-line one, in the residual part that the region
    is read from.
    """

    verdict: Verdict
    region: Region
    changes: Mapping[Cell, float]


def compare(
    offline: Sample, online: Sample, *, alpha: float, tolerance: float | None, generator: np.random.Generator
) -> Difference:
    """Judge the on-line world against the off-line one; `tolerance` is the loss per episode that nobody minds."""
    offline, online = aligned(offline, online)
    margin = max(0.05 * abs(float(offline.total.mean())), tolerance or 0.0)
    p_loss = permuted_loss(offline.total, online.total, generator)
    loss = float(offline.total.mean() - online.total.mean())
    p_drift, region, changes = _drift(offline, online, alpha, generator)
    result: Result = "no difference"
    if p_loss < alpha and loss > margin:
        result = "degraded"
    elif p_drift < alpha:
        result = "drifted"
    detectable = max(margin, smallest_detectable_loss(offline.total, online.total, alpha))
    found = region if result != "no difference" else Region()
    return Difference(Verdict(result, p_drift, p_loss, loss, detectable, margin), found, changes)


def in_fit(seed: int) -> bool:
    """Tell whether an off-line episode is one that the utility is fitted on; the others are compared with."""
    return zlib.crc32(str(seed).encode()) % 2 == 0


def permuted_loss(offline: Floats, online: Floats, generator: np.random.Generator) -> float:
    """Return the one-sided permutation p-value for a lower mean on-line; inputs have shape (episodes,)."""
    pooled = np.concatenate((online, offline))
    pooled -= pooled.mean()
    shuffled = _labels(pooled.size, online.size, generator) @ pooled
    tie = 1e-9 * float(np.abs(pooled).sum())  # sums of the same numbers in another order
    return (1 + int(np.count_nonzero(shuffled[1:] <= shuffled[0] + tie))) / shuffled.size


def smallest_detectable_loss(offline: Floats, online: Floats, alpha: float) -> float:
    """Return the loss that a test of this size would have seen four times in five, by normal approximation.

    Infinite where so few episodes can be shuffled in so few ways that no loss is significant.
    """
    if alpha * comb(offline.size + online.size, online.size) <= 1:
        return inf
    spread = np.sqrt(_variance(offline) / offline.size + _variance(online) / online.size)
    normal = NormalDist()
    return float((normal.inv_cdf(1 - alpha) + normal.inv_cdf(POWER)) * spread)


@dataclass(frozen=True)
class Model:
    """What one step is expected to bring in each cell of the off-line world, shape (cells,); NaN where unknown."""

    utility: Floats
    move: Floats  # mean of γU(x')-U(x) over the steps that are not the last
    reward: Floats


def fitted(chain: Chain, cells: int) -> Model:
    """Fit the model to off-line transitions."""
    utility = chain_utility(chain, cells)
    inside = chain.next_cell != END
    moves = sum_by(chain.cell, _gain(chain, utility) * chain.count, cells)
    rewards = sum_by(chain.cell, chain.reward, cells)
    with np.errstate(invalid="ignore", divide="ignore"):
        move = moves / sum_by(chain.cell, chain.count * inside, cells)
        reward = rewards / sum_by(chain.cell, chain.count, cells)
    return Model(utility, move, reward)


def residuals(compared: Sample, model: Model) -> Residuals:
    """Return each episode's residuals per cell, each part less what the off-line world brings per visit.

    So both parts are zero in expectation in that world, however often a cell is visited. The last step of an episode
    has no move. Transitions from or to a cell of unknown utility are left out.
    """
    chain, shape = compared.chain, (compared.episodes, len(compared.cells))
    known = ~np.isnan(model.utility)
    move = (_gain(chain, model.utility) - model.move[chain.cell]) * chain.count
    move = np.where((chain.next_cell != END) & ~np.isnan(move), move, 0.0)
    reward = chain.reward - model.reward[chain.cell] * chain.count
    return Residuals(
        move=_by_episode(chain, move, shape),
        reward=_by_episode(chain, np.where(known[chain.cell], reward, 0.0), shape),
        novel=_by_episode(chain, np.where(known[chain.cell], 0.0, chain.count), shape),
    )


def _gain(chain: Chain, utility: Floats) -> Floats:
    """Return γU(x')-U(x) of every transition, 0 for the last step, NaN where a utility is unknown."""
    inside = chain.next_cell != END
    return np.where(
        inside, GAMMA_STEP * utility[np.where(inside, chain.next_cell, 0)] - utility[chain.cell], 0.0
    )


def _drift(
    offline: Sample, online: Sample, alpha: float, generator: np.random.Generator
) -> tuple[float, Region, dict[Cell, float]]:
    """Return p_drift, the region and the change by cell; both samples share their cells."""
    fit = np.array([in_fit(seed) for seed in offline.seeds])
    rows = fit[offline.chain.episode]
    known = type(offline.chain)(*(column[rows] for column in vars(offline.chain).values()))
    model = fitted(known, len(offline.cells))
    held_out, deployed = residuals(offline, model), residuals(online, model)
    blocks = [
        np.concatenate((getattr(deployed, part), getattr(held_out, part)[~fit]))
        for part in ("move", "reward", "novel")
    ]
    visited = (blocks[2] > 0).sum(axis=0) >= NOVEL_EPISODES
    blocks[2] = np.where(visited & (blocks[2].sum(axis=0) >= NOVEL_VISITS), np.minimum(blocks[2], 1.0), 0.0)
    p_values = max_statistic(np.concatenate(blocks, axis=1), online.episodes, generator)
    significant = [part < alpha for part in np.split(p_values, 3)]
    part = 0 if significant[0].any() else 1
    difference = blocks[part][: online.episodes].mean(axis=0) - blocks[part][online.episodes :].mean(axis=0)
    seen = np.zeros(len(offline.cells), dtype=bool)
    seen[offline.chain.cell] = True
    chosen = (outstanding(difference, significant[part]), significant[2] & ~seen)
    region = Region(*(tuple(offline.cells[i] for i in np.flatnonzero(one)) for one in chosen))
    changes = {offline.cells[i]: abs(float(difference[i])) for i in np.flatnonzero(difference)}
    return float(p_values.min(initial=1.0)), region, changes


def outstanding(difference: Floats, significant: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the significant cells that matter beside the largest of them, shape (cells,).

    What off-line steps bring per visit is known up to an error. Where on-line episodes come by more or less often, a
    trace of it shows, and enough episodes make it significant: but it stays small.
    """
    size = np.where(significant, np.abs(difference), 0.0)
    material: NDArray[np.bool_] = size >= MATERIAL * size.max(initial=0.0)
    return significant & material


def max_statistic(columns: Floats, first: int, generator: np.random.Generator) -> Floats:
    """Return each column's p-value corrected over all columns, shape (columns,).

    The first `first` rows are one group, the others the other. The statistic is the difference of the groups' means in
    units of the column's standard deviation, which orders columns as the pooled t statistic does.
    """
    deviation = columns - columns.mean(axis=0)
    scale = np.sqrt((deviation**2).mean(axis=0))
    alive = scale > 1e-12 * np.maximum(1.0, np.abs(columns).max(axis=0, initial=0.0))
    p_values = np.ones(columns.shape[1])
    if not alive.any() or not 0 < first < columns.shape[0]:
        return p_values
    standard = deviation[:, alive] / scale[alive]
    statistic = np.abs(_labels(columns.shape[0], first, generator) @ standard)
    largest = statistic.max(axis=1)
    reached = largest[1:, None] >= statistic[0] - 1e-9
    p_values[alive] = (1 + reached.sum(axis=0)) / statistic.shape[0]
    return p_values


def paper_region(offline: Floats, online: Floats) -> Ints:
    """Return the cells whose utility differs by at least half of the largest difference, as the paper's region.

    Inputs have shape (cells, sites), NaN where a world never was; only what both have visited counts.
    """
    gap = np.abs(np.nansum(online - offline, axis=1))
    return np.flatnonzero(gap >= 0.5 * gap.max()) if gap.max(initial=0.0) > 0 else np.empty(0, dtype=np.int64)


def _labels(rows: int, first: int, generator: np.random.Generator) -> Floats:
    """Return group indicators, shape (1 + PERMUTATIONS, rows): as observed, then shuffled."""
    observed = np.zeros(rows)
    observed[:first] = 1.0
    labels = np.tile(observed, (1 + PERMUTATIONS, 1))
    labels[1:] = generator.permuted(labels[1:], axis=1)
    return labels


def _by_episode(chain: Chain, weights: Floats, shape: tuple[int, int]) -> Floats:
    """Return the sums per episode and cell, shape (episodes, cells)."""
    return sum_by(chain.episode * shape[1] + chain.cell, weights, shape[0] * shape[1]).reshape(shape)


def _variance(values: NDArray[np.float64]) -> float:
    return float(values.var(ddof=1)) if values.size > 1 else 0.0
