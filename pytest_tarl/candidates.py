"""Candidate guards: what region, novelty and single sensors propose; simulation selects among them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from pytest_tarl.model import Conjunct, Guard, Region
from pytest_tarl.sensors import Cell, Sensor
from pytest_tarl.statistics import Sample

ALWAYS = Guard()
WIDER = 2  # bins by which an interval is widened on either side, as a last proposal


def candidate_guards(
    region: Region, sensors: Sequence[Sensor], worlds: Sequence[Sample]
) -> tuple[Guard, ...]:
    """Return the guards worth simulating, fewest conditions first, then the narrowest in the given worlds.

    `worlds` are the samples that tell which bins occur at all: a condition that always holds there is none.
    """
    cells = (*region.cells, *region.novel)
    proposals = [ALWAYS, *_hulls(cells, sensors, worlds), *_hulls(region.novel, sensors, worlds)]
    proposals += [_widened(guard, sensors) for guard in proposals if guard.conjuncts]
    distinct = list(dict.fromkeys(proposals))
    return tuple(sorted(distinct, key=lambda guard: (len(guard.conjuncts), share(guard, worlds[0], sensors))))


def telling(
    guards: Iterable[Guard], losses: Mapping[Cell, float], world: Sample, sensors: Sequence[Sensor], most: int
) -> tuple[Guard, ...]:
    """Return the guards to search under: those that hold where much is lost and seldom elsewhere, and none at all.

    Ordered by the share of the loss that falls under the guard less the share of steps that do (Youden's J).
    """
    lost = {cell: loss for cell, loss in losses.items() if loss > 0}
    whole = sum(lost.values()) or 1.0

    def merit(guard: Guard) -> float:
        covered = sum(loss for cell, loss in lost.items() if holds(guard, cell, sensors))
        return covered / whole - share(guard, world, sensors)

    ranked = sorted((guard for guard in guards if guard.conjuncts), key=lambda guard: -merit(guard))
    best = [guard for guard in ranked if merit(guard) > 0][: most - 1]
    return (*best, ALWAYS)


def share(guard: Guard, world: Sample, sensors: Sequence[Sensor]) -> float:
    """Return the share of steps with a known cell in which the guard holds."""
    steps = np.bincount(world.chain.cell, weights=world.chain.count, minlength=len(world.cells))
    holding = np.array([holds(guard, cell, sensors) for cell in world.cells], dtype=bool)
    return float(steps[holding].sum() / max(steps.sum(), 1.0))


def firing_episodes(guard: Guard, world: Sample, sensors: Sequence[Sensor]) -> tuple[int, ...]:
    """Return the seeds of the episodes in which the guard holds at least once."""
    holding = np.array([holds(guard, cell, sensors) for cell in world.cells], dtype=bool)
    firing = np.unique(world.chain.episode[holding[world.chain.cell]])
    return tuple(world.seeds[i] for i in firing)


def holds(guard: Guard, cell: Cell, sensors: Sequence[Sensor]) -> bool:
    """Tell whether the guard is true in a cell; its bounds lie on those of bins."""
    bins = dict(zip((sensor.name for sensor in sensors), cell, strict=True))
    return all(_within(conjunct, bins[conjunct.sensor.name]) for conjunct in guard.conjuncts)


def _within(conjunct: Conjunct, index: int) -> bool:
    low, high = conjunct.sensor.interval(index, index)
    slack = 1e-9 * max(1.0, abs(low), abs(high)) if np.isfinite(high - low) else 0.0
    return conjunct.low <= low + slack and high - slack <= conjunct.high


def _hulls(cells: Sequence[Cell], sensors: Sequence[Sensor], worlds: Sequence[Sample]) -> list[Guard]:
    """Return the projections of the cells on single sensors and on pairs of them."""
    if not cells:
        return []
    conjuncts = []
    for i, sensor in enumerate(sensors):
        seen = {cell[i] for world in worlds for cell in world.cells}
        chosen = {cell[i] for cell in cells}
        first, last = min(chosen), max(chosen)
        everywhere = first <= min(seen) and last >= max(seen)
        contiguous = sensor.numeric or chosen == {b for b in seen if first <= b <= last}
        if sensor.guardable and not everywhere and contiguous:
            conjuncts.append(_conjunct(sensor, first, last, seen))
    return [Guard(pick) for size in (1, 2) for pick in combinations(conjuncts, size)]


def _conjunct(sensor: Sensor, first: int, last: int, seen: set[int]) -> Conjunct:
    """Return the interval of the bins, left open at an end beyond which nothing was ever seen."""
    low, high = sensor.interval(first, last)
    if sensor.numeric:
        low = -np.inf if first <= min(seen) else low
        high = np.inf if last >= max(seen) else high
    return Conjunct(sensor, float(low), float(high))


def _widened(guard: Guard, sensors: Sequence[Sensor]) -> Guard:
    """Widen every numeric interval by a few bins."""
    by_name = {sensor.name: sensor for sensor in sensors}
    wider = []
    for conjunct in guard.conjuncts:
        sensor = by_name[conjunct.sensor.name]
        step = 0.0
        if sensor.bins is not None and sensor.low is not None and sensor.high is not None:
            step = WIDER * (sensor.high - sensor.low) / sensor.bins
        wider.append(Conjunct(sensor, conjunct.low - step, conjunct.high + step))
    return Guard(tuple(wider))
