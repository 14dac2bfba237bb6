"""Candidate guards, the conditions under which a repair applies.

The module proposes guards from the region of change, from cells that only the drifted world visits, and from single
sensors. Simulations then select among these guards.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.tables import Sample
from pytest_tarl.model import Conjunct, Guard, Region
from pytest_tarl.sensors import Cell, Sensor

ALWAYS = Guard()
COVERED = 0.95  # a guard that holds in this share of the drifted steps counts as holding everywhere
# in the drifted world, a guard that holds in this share of the steps has the same effect as no guard
ENTIRELY = 0.999
# bonus for the merit of a guard that never holds in the designed world, as a share of the change
HARMLESS = 0.25
CONDITION = 0.1  # a second condition reduces the merit of a guard by this share of the change
EVERYWHERE = 0.3  # if no guard has at least this merit, the drift counts as present everywhere
WIDER = 2  # number of bins by which the last proposals widen an interval on each side

Bins = tuple[int, int]  # first and last bin, both included


@dataclass(frozen=True)
class Evidence:
    """The data from which guards are proposed: samples of both worlds, the region of change, and each cell's change."""

    sensors: Sequence[Sensor]
    offline: Sample
    online: Sample
    region: Region
    changes: Mapping[Cell, float]

    def shares(self) -> dict[Cell, float]:
        """For each cell, return its share of the change minus its share of the designed steps.

        A novel cell was never visited in the designed world, so its share of the change is set to its share of the
        drifted steps. The other cells divide the rest of the change in proportion to their own change.
        """
        visited, designed = _occupancy(self.online), _occupancy(self.offline)
        novel = {cell: visited.get(cell, 0.0) for cell in self.region.novel}
        known = {c: change for c, change in self.changes.items() if c in visited and c not in novel}
        scale = (1.0 - sum(novel.values())) / (sum(known.values()) or 1.0)
        changed = {cell: change * scale for cell, change in known.items()} | novel
        cells = dict.fromkeys((*changed, *designed, *visited))
        return {cell: changed.get(cell, 0.0) - designed.get(cell, 0.0) for cell in cells}


def candidate_guards(evidence: Evidence) -> tuple[Guard, ...]:
    """Return the guards worth simulating. Guards with few conditions that cover few designed steps come first."""
    region = evidence.region
    proposals = [
        ALWAYS,
        *_combined(
            [_hull((*region.cells, *region.novel), i, one) for i, one in enumerate(evidence.sensors)],
            evidence,
        ),
        *_combined([_hull(region.novel, i, one) for i, one in enumerate(evidence.sensors)], evidence),
        *_combined([_steepest(evidence, i) for i in range(len(evidence.sensors))], evidence),
        *_values(evidence),
    ]
    proposals += [_widened(guard) for guard in proposals]
    offline, sensors = evidence.offline, evidence.sensors
    return tuple(
        sorted(
            dict.fromkeys(map(_asking, proposals)),
            key=lambda guard: (len(guard.conjuncts), share(guard, offline, sensors)),
        )
    )


def telling(guards: Iterable[Guard], evidence: Evidence, most: int) -> tuple[Guard, ...]:
    """Return at most `most` guards to search under: `ALWAYS`, and guards that hold mainly where much changed.

    A guard's merit is the share of the change where it holds minus the share of designed steps where it holds (Youden's
    J). A guard that never holds in the designed world gets a bonus, and a second condition has a cost. `ALWAYS` usually
    comes second. It comes first in two cases:

    - No guard has much merit, so the drift seems to be everywhere.
    - The best guard holds wherever the drifted robot went, so it says nothing about places that only a repaired robot
      reaches.
    """
    shares, designed = evidence.shares(), evidence.offline

    def merit(guard: Guard) -> float:
        told = sum(part for cell, part in shares.items() if holds(guard, cell, evidence.sensors))
        harmless = HARMLESS if share(guard, designed, evidence.sensors) == 0.0 else 0.0
        return told + harmless - CONDITION * (len(guard.conjuncts) - 1)

    ranked = sorted((guard for guard in guards if guard.conjuncts), key=lambda guard: -merit(guard))
    best = [guard for guard in ranked if merit(guard) > 0][: most - 1]
    if not best or merit(best[0]) < EVERYWHERE:
        return (ALWAYS, *best)
    covered = share(best[0], evidence.online, evidence.sensors)
    if covered >= ENTIRELY:
        # drifted episodes cannot distinguish the guard from `ALWAYS`, so the acceptance test tries the guard, too
        return (ALWAYS,)
    if covered >= COVERED:
        return (ALWAYS, best[0])  # the test in the designed world decides whether the guard is needed
    return (best[0], ALWAYS, *best[1:])


def share(guard: Guard, world: Sample, sensors: Sequence[Sensor]) -> float:
    """Among a world's steps in known cells, return the share of steps at which the guard holds."""
    steps = np.bincount(world.chain.cell, weights=world.chain.count, minlength=len(world.cells))
    return float(steps[_holding(guard, world, sensors)].sum() / max(steps.sum(), 1.0))


def _occupancy(world: Sample) -> dict[Cell, float]:
    """Return the share of a world's steps in each visited cell."""
    counts = np.bincount(world.chain.cell, world.chain.count, minlength=len(world.cells))
    steps = max(float(counts.sum()), 1.0)
    return {cell: count / steps for cell, count in zip(world.cells, counts.tolist(), strict=True) if count}


def firing_episodes(guard: Guard, world: Sample, sensors: Sequence[Sensor]) -> tuple[int, ...]:
    """Return the seeds of the episodes in which the guard holds at least once."""
    firing = np.unique(world.chain.episode[_holding(guard, world, sensors)[world.chain.cell]])
    return tuple(world.seeds[i] for i in firing)


def holds(guard: Guard, cell: Cell, sensors: Sequence[Sensor]) -> bool:
    """Return whether the guard holds in a cell. The bounds of guards are always bounds of bins."""
    bins = dict(zip((sensor.name for sensor in sensors), cell, strict=True))
    return all(_within(conjunct, bins[conjunct.sensor.name]) for conjunct in guard.conjuncts)


def _holding(guard: Guard, world: Sample, sensors: Sequence[Sensor]) -> NDArray[np.bool_]:
    return np.array([holds(guard, cell, sensors) for cell in world.cells], dtype=bool)


def _within(conjunct: Conjunct, index: int) -> bool:
    low, high = conjunct.sensor.interval(index, index)
    slack = 1e-9 * max(1.0, abs(low), abs(high)) if np.isfinite(high - low) else 0.0
    if conjunct.low > conjunct.high:  # this interval of angles wraps around the end of the range
        return conjunct.low <= low + slack or high - slack <= conjunct.high
    return conjunct.low <= low + slack and high - slack <= conjunct.high


def _hull(cells: Sequence[Cell], i: int, sensor: Sensor) -> Bins | None:
    """Return the bins that the cells span on a sensor; for an angle, the shortest arc."""
    chosen = sorted({cell[i] for cell in cells})
    if not chosen:
        return None
    if not sensor.angle or sensor.bins is None:
        return chosen[0], chosen[-1]
    gaps = [after - before for before, after in pairwise([*chosen, chosen[0] + sensor.bins])]
    start = (gaps.index(max(gaps)) + 1) % len(chosen)
    return chosen[start], chosen[start - 1] + (sensor.bins if start else 0)


def _steepest(evidence: Evidence, i: int) -> Bins | None:
    """Return the interval of bins with the largest sum of `shares`; it may wrap for angles."""
    by_bin: dict[int, float] = {}
    for cell, value in evidence.shares().items():
        by_bin[cell[i]] = by_bin.get(cell[i], 0.0) + value
    best, best_sum, start, running = None, 0.0, None, 0.0
    sensor = evidence.sensors[i]
    turn = sensor.bins if sensor.angle and sensor.bins else 0
    order = sorted(by_bin)
    by_bin |= {index + turn: by_bin[index] for index in order}
    for index in [*order, *(index + turn for index in order if turn)]:
        if turn and start is not None and index - start >= turn:
            break
        if running <= 0.0:
            start, running = index, 0.0
        running += by_bin[index]
        if running > best_sum and start is not None:
            best, best_sum = (start, index), running
    return best


def _values(evidence: Evidence) -> Iterator[Guard]:
    """Yield a guard for each value that a boolean or categorical sensor took in the drifted world."""
    for i, sensor in enumerate(evidence.sensors):
        met = sorted({cell[i] for cell in evidence.online.cells}) if not sensor.numeric else []
        for index in met:
            only = [(index, index) if at == i else None for at in range(len(evidence.sensors))]
            yield from _combined(only, evidence)


def _combined(intervals: Sequence[Bins | None], evidence: Evidence) -> Iterator[Guard]:
    """Yield conditions on one and two sensors that can be false and that a node can check."""
    conjuncts = []
    for i, (sensor, bins) in enumerate(zip(evidence.sensors, intervals, strict=True)):
        seen = {cell[i] for world in (evidence.offline, evidence.online) for cell in world.cells}
        everywhere = bins is None or _spans(bins, seen, sensor)
        if bins is not None and sensor.guardable and not everywhere:
            conjuncts.append(_conjunct(sensor, bins, seen))
    for size in (1, 2):
        yield from map(Guard, combinations(conjuncts, size))


def _spans(bins: Bins, seen: set[int], sensor: Sensor) -> bool:
    """Return whether the bins contain every bin that was ever visited."""
    turn = sensor.bins if sensor.angle and sensor.bins else 0
    return all(bins[0] <= index <= bins[1] or bins[0] <= index + turn <= bins[1] for index in seen)


def _conjunct(sensor: Sensor, bins: Bins, seen: set[int]) -> Conjunct:
    """Return the interval of the bins, unbounded at an end without visited bins beyond it."""
    low, high = sensor.interval(*bins)
    if sensor.numeric and not sensor.angle:
        low = -np.inf if bins[0] <= min(seen) else low
        high = np.inf if bins[1] >= max(seen) else high
    return Conjunct(sensor, float(low), float(high))


def _asking(guard: Guard) -> Guard:
    """Drop conditions that always hold, so that guards with the same meaning compare equal."""
    return Guard(tuple(one for one in guard.conjuncts if np.isfinite(one.low) or np.isfinite(one.high)))


def _widened(guard: Guard) -> Guard:
    """Widen every numeric interval by `WIDER` bins on either side."""
    return Guard(tuple(_wider(conjunct) for conjunct in guard.conjuncts))


def _wider(conjunct: Conjunct) -> Conjunct:
    sensor = conjunct.sensor
    if not sensor.bins or sensor.low is None or sensor.high is None:
        return conjunct
    if sensor.angle:
        return _wider_arc(conjunct, sensor.low, sensor.high - sensor.low)
    step = WIDER * sensor.resolution
    low, high = conjunct.low - step, conjunct.high + step
    within = 1e-9 * step
    # All values below the sensor's range share one bin, and so do all values above it. The guard holds in a whole bin
    # or not at all.
    return Conjunct(
        sensor,
        low if low >= sensor.low - within else -np.inf,
        high if high <= sensor.high + within else np.inf,
    )


def _wider_arc(conjunct: Conjunct, low: float, period: float) -> Conjunct:
    """Widen the arc of an angle; an arc that would close on itself becomes unbounded."""
    step = WIDER * conjunct.sensor.resolution
    if (conjunct.high - conjunct.low) % period + 2 * step >= period - 1e-9 * period or np.isinf(conjunct.low):
        return Conjunct(conjunct.sensor, -np.inf, np.inf)
    start, end = ((at - low) % period + low for at in (conjunct.low - step, conjunct.high + step))
    return Conjunct(conjunct.sensor, start, end)
