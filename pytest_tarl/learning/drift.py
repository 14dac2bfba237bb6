"""Compare two worlds: test for a loss of performance and for a drift, and find the cells that differ.

The designed world is the recorded one (`offline`); the deployed world is compared with it (`online`). A cell is a
combination of sensor bins. The drift test compares Bellman residuals: the difference between what a step earns and what
the recorded utility predicts for it. It permutes whole episodes, and corrects p-values over all columns by the largest
statistic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import comb

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.bounds import Range, detectable_loss, loss_between
from pytest_tarl.learning.marginal import groups, left_out, projected
from pytest_tarl.learning.merging import aligned
from pytest_tarl.learning.multiple_testing import holm
from pytest_tarl.learning.packing import represented_chain
from pytest_tarl.learning.permutation import PERMUTATIONS, max_statistic, permuted_decreases
from pytest_tarl.learning.residual_sums import gathered
from pytest_tarl.learning.tables import Floats, Ints, Sample
from pytest_tarl.model import Decreased, LossInterval, Region, Result, Verdict
from pytest_tarl.sensors import Cell, Sensor

# minimum difference of a cell in the region, as a share of the largest significant difference
MATERIAL = 0.1
PASS_RATE_LOSS = 0.05  # tolerated decrease of the success rate


@dataclass(frozen=True)
class Difference:
    """The result of comparing two samples of episodes.

    For each cell, `changes` is the difference between the worlds in one part of the residual (move or reward): the part
    that determined the region.
    """

    verdict: Verdict
    region: Region
    changes: Mapping[Cell, float]


def tolerated(offline: Sample, stated: float | None) -> float:
    """Return δ, the tolerated loss per episode.

    δ is the larger of 5 % of the mean recorded reward and the marker's tolerance.
    """
    return max(0.05 * abs(float(offline.total.mean())), stated or 0.0)


def compare(
    offline: Sample,
    online: Sample,
    *,
    alpha: float,
    tolerance: float | None,
    generator: np.random.Generator,
    sensors: Sequence[Sensor] = (),
    permutations: int = PERMUTATIONS,
    declared: Range | None = None,
) -> Difference:
    """Compare the deployed world with the designed one; `tolerance` is the tolerated loss per episode.

    `sensors` are needed only for tiled utilities; without them, the utility is a table. Correcting p-values over many
    comparisons takes more `permutations`. `declared` is the range of totals, if known. Both samples are rounded as in a
    recording.
    """
    offline, online = aligned(as_compared(offline), as_compared(online))
    margin = tolerated(offline, tolerance)
    p_loss, p_failures = permuted_decreases(outcomes(offline), outcomes(online), generator, permutations)
    loss = float(offline.total.mean() - online.total.mean())
    p_drift, region, changes = _drift(offline, online, alpha, generator, sensors, permutations)
    without = left_out(offline, online)
    if without:
        region, changes = _compared_without(without, offline, online, alpha, generator, sensors, region)
    detectable = max(margin, detectable_loss(offline.total, online.total, alpha))
    bounds = loss_bounds(offline.total, online.total, alpha, declared)
    interval = LossInterval(*bounds, 1 - 2 * alpha, declared is not None)
    success = float(offline.passed.mean()), float(online.passed.mean())
    verdict = judged(
        Verdict(
            "no difference",
            p_drift,
            float(p_loss),
            loss,
            detectable,
            margin,
            interval,
            float(p_failures),
            success,
        ),
        alpha,
    )
    found = region if verdict.result != "no difference" else Region()
    return Difference(verdict, found, changes)


def as_compared(sample: Sample) -> Sample:
    """Return the sample with its chain, the only part that is compared, rounded as in a recording."""
    return replace(sample, chain=represented_chain(sample.chain))


def outcomes(sample: Sample) -> Floats:
    """Return what should not decrease: each episode's total and success, shape (episodes, 2)."""
    return np.stack([sample.total, sample.passed.astype(np.float64)], axis=1)


def succeed_less(success: tuple[float, float]) -> bool:
    """Return whether the second success rate is lower than the first by more than PASS_RATE_LOSS."""
    before, after = success
    # allow for rounding: 1 - 0.95 is slightly above 0.05 in floating point
    return before - after > PASS_RATE_LOSS + 1e-9


def judged(verdict: Verdict, alpha: float) -> Verdict:
    """Return the verdict with its result, derived from its p-values, loss and success rates."""
    reasons: list[Decreased] = []
    if verdict.p_loss < alpha and verdict.loss > verdict.tolerance:
        reasons.append("reward")
    if verdict.p_failures < alpha and succeed_less(verdict.success):
        reasons.append("success")
    result: Result = "degraded" if reasons else "drifted" if verdict.p_drift < alpha else "no difference"
    return replace(verdict, result=result, because=tuple(reasons))


def corrected(verdicts: Sequence[Verdict], alpha: float) -> list[Verdict]:
    """Return the verdicts of several comparisons with p-values corrected by Holm, and updated results.

    A comparison has a p-value for a drift, and one for a worse world. The latter is the smaller of two p-values: for a
    loss, and for more failures. The correction multiplies the larger of these two by the same factor.
    """
    drifts, worse = (holm([getattr(one, name) for one in verdicts]) for name in ("p_drift", "p_worse"))
    found = []
    for one, drift, most in zip(verdicts, drifts, worse, strict=True):
        p_loss, p_failures = (
            most if value == one.p_worse else min(1.0, value * most / one.p_worse)
            for value in (one.p_loss, one.p_failures)
        )
        found.append(judged(replace(one, p_drift=drift, p_loss=p_loss, p_failures=p_failures), alpha))
    return found


def loss_bounds(
    offline: Floats, online: Floats, risk: float, declared: Range | None = None
) -> tuple[float, float]:
    """Return the confidence interval of the loss, with `risk` at each end; totals have shape (episodes,)."""
    bound = loss_between(offline.tolist(), online.tolist(), 1.0 - risk, declared)
    return bound.low, bound.high


def _compared_without(
    without: Sequence[int],
    offline: Sample,
    online: Sample,
    alpha: float,
    generator: np.random.Generator,
    sensors: Sequence[Sensor],
    found: Region,
) -> tuple[Region, dict[Cell, float]]:
    """Compare the worlds without some sensors; return the region and the change in each deployed cell.

    This does not affect p_drift, so it adds no false alarms.
    """
    kept = [sensor for d, sensor in enumerate(sensors) if d not in without]
    shorter = projected(offline, without), projected(online, without)
    _, region, changes = _drift(*shorter, alpha, generator, kept, PERMUTATIONS)
    rows = np.unique(online.chain.cell).tolist()
    short = dict(zip(online.cells, groups(online.cells, without)[1].tolist(), strict=True))
    chosen = {*region.cells, *region.novel}
    alike = {online.cells[row]: shorter[0].cells[short[online.cells[row]]] for row in rows}
    cells = tuple(cell for cell in alike if alike[cell] in chosen)
    widened = {cell: changes[one] for cell, one in alike.items() if one in changes}
    return replace(found, cells=cells, left=(), without=tuple(without)), widened


def _drift(
    offline: Sample,
    online: Sample,
    alpha: float,
    generator: np.random.Generator,
    sensors: Sequence[Sensor],
    permutations: int,
) -> tuple[float, Region, dict[Cell, float]]:
    """Return p_drift, the region, and the change by cell; both samples must use the same table of cells."""
    evidence = gathered(offline, online, sensors)
    blocks = evidence.columns()
    p_values = max_statistic(np.concatenate(blocks, axis=1), online.episodes, generator, permutations)
    ends = np.cumsum([block.shape[1] for block in blocks])
    move, reward, novel, wide_move, wide_reward, _ = (part < alpha for part in np.split(p_values, ends[:-1]))
    found: tuple[tuple[Floats, NDArray[np.bool_]], ...] = (
        (evidence.move, move),
        (evidence.move, evidence.covered(wide_move)),
        (evidence.reward, reward),
        (evidence.reward, evidence.covered(wide_reward)),
    )
    part, significant = next((one for one in found if one[1].any()), found[2])
    difference = part[: online.episodes].mean(axis=0) - part[online.episodes :].mean(axis=0)
    seen = np.zeros(len(offline.cells), dtype=bool)
    seen[offline.chain.cell] = True
    met = np.zeros(len(offline.cells), dtype=bool)
    met[online.chain.cell] = True
    chosen = (outstanding(difference, significant) & met, novel & ~seen, avoided(offline, online, alpha))
    cells, new, left = (tuple(offline.cells[i] for i in np.flatnonzero(one)) for one in chosen)
    region = Region(cells, new, left)
    changes = {offline.cells[i]: abs(float(difference[i])) for i in np.flatnonzero(difference)}
    return float(p_values.min(initial=1.0)), region, changes


def avoided(offline: Sample, online: Sample, alpha: float) -> NDArray[np.bool_]:
    """Return the cells that deployed episodes avoid significantly, as booleans of shape (cells,).

    Of N episodes in total, n are deployed and K visit a cell. If the worlds are equal, the probability that no deployed
    episode visits the cell is C(N - K, n) / C(N, n). A cell counts as avoided if this is below α divided by the number
    of candidate cells.
    """
    been = np.unique(offline.chain.episode * len(offline.cells) + offline.chain.cell) % len(offline.cells)
    often = np.bincount(been, minlength=len(offline.cells))
    often[online.chain.cell] = 0
    everyone, few = offline.episodes + online.episodes, online.episodes
    limit = alpha / max(int((often > 0).sum()), 1)
    chance = [comb(everyone - int(k), few) / comb(everyone, few) if k else 1.0 for k in often]
    return np.array(chance) < limit


def outstanding(difference: Floats, significant: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the significant cells whose difference is at least MATERIAL times the largest, shape (cells,).

    The designed mean per visit has an estimation error. If deployed episodes visit a cell more or less often than
    designed ones, this error becomes significant with enough episodes, but remains small. The limit removes such cells.
    """
    size = np.where(significant, np.abs(difference), 0.0)
    material: NDArray[np.bool_] = size >= MATERIAL * size.max(initial=0.0)
    return significant & material


def paper_region(offline: Floats, online: Floats) -> Ints:
    """Return the region as the paper defines it: cells whose utilities differ by at least half of the maximum.

    Inputs have shape (cells, sites), with NaN where unvisited. Only entries visited in both worlds count.
    """
    gap = np.abs(np.nansum(online - offline, axis=1))
    return np.flatnonzero(gap >= 0.5 * gap.max()) if gap.max(initial=0.0) > 0 else np.empty(0, dtype=np.int64)
