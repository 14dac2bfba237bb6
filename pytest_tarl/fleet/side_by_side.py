"""Run the monitors of many robots at once, with exactly the results of separate monitors.

All robots start with the same pool, and the random numbers that break ties depend only on the index of a mission. The
n-th missions of many robots can therefore be judged in one step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from pytest_tarl.fleet.scores import Scores
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring import bet_updates, conformal
from pytest_tarl.monitoring.monitor import Monitor
from pytest_tarl.monitoring.restarts import Processes, log_evidence

COLUMNS = 512  # number of processes judged together, so that their state fits into the processor's cache


@dataclass(frozen=True)
class Watched:
    """Robots after all their missions; for the columns see bet_updates.py."""

    robots: Ints  # index of each robot in the fleet
    processes: Processes
    pool: Ints
    bounds: int

    @property
    def scores(self) -> int:
        """Return the number of scores of each mission."""
        return len(self.pool) // len(self.robots)

    def peaks(self) -> Floats:
        """Return log2 of each process's largest evidence so far, shape (robots, processes)."""
        return self._by_robot(self.processes.peak)

    def latest(self) -> Floats:
        """Return log2 of each robot's evidence after its last mission, shape (robots, processes)."""
        return self._by_robot(log_evidence(self.processes))

    def _by_robot(self, columns: Floats) -> Floats:
        size = len(self.robots)
        stated, scored = np.split(columns, [self.bounds * size])
        return np.concatenate((stated.reshape(-1, size).T, scored.reshape(size, -1)), axis=1)

    def state(self, place: int) -> tuple[Processes, Ints]:
        """Return the processes of one robot, and its pool of shape (scores, bins)."""
        mine = bet_updates.columns(self.bounds, self.scores, len(self.robots), place)
        values = {one.name: getattr(self.processes, one.name)[..., mine] for one in fields(Processes)}
        return Processes(**values), self.pool[place * self.scores : (place + 1) * self.scores]


def watched(
    first: Monitor, scores: Scores, ends: Ints, some: Ints | None = None, onsets: bool = True
) -> Iterator[Watched]:
    """Judge the missions of robots, in batches of robots with similar numbers of missions.

    - `first`: a monitor without missions
    - `ends`, shape (robots,): the missions of robot n end before `ends[n]`
    - `some`, shape (chosen,): indices of the robots to judge; all by default
    - `onsets`: False skips tracking the start of differences, which is faster
    """
    begins = np.append(0, ends[:-1])
    counts = ends - begins
    together = max(1, COLUMNS // first.processes.count)
    chosen = np.arange(counts.size) if some is None else some
    order = chosen[np.argsort(counts[chosen], kind="stable")]
    for begin in range(0, order.size, together):
        robots = order[begin : begin + together]
        yield _judged(first, scores, robots, begins[robots], counts[robots], onsets)


def _judged(
    first: Monitor, scores: Scores, robots: Ints, begins: Ints, counts: Ints, onsets: bool
) -> Watched:
    bounds, size = len(first.bounds), len(robots)
    processes = bet_updates.begun(first.processes.threshold, bounds, size)
    pool = np.tile(first.pool, (size, 1))
    for begin in range(0, int(counts.max()), conformal.TOGETHER):
        number = np.arange(begin, min(begin + conformal.TOGETHER, int(counts.max())))
        there = number[:, None] < counts
        mission = np.where(there, begins + number[:, None], 0)
        pool = bet_updates.judged(
            first.bounds,
            processes,
            pool,
            scores.passed[mission],
            scores.total[mission],
            np.where(there[:, :, None], scores.bins[mission], -1).astype(np.int64),
            first.draws(begin, number.size),
            begin,
            np.clip(counts - begin, 0, number.size),
            onsets,
        )
    return Watched(robots, processes, pool, bounds)
