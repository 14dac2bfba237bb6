"""The monitor: an e-process for each bound, a conformal martingale for each score, and the alarms.

An e-process measures evidence that may be checked at any time. Two tests share α: whether performance is below the
recorded bound, and whether missions differ from the recorded ones. Each divides its half of α among its processes
(union bound). The probability of any false alarm is therefore at most α, plus the probability that a recorded bound is
wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pytest_tarl.learning.fixture import Fixture
from pytest_tarl.learning.tables import Floats, Ints, Sample
from pytest_tarl.monitoring import conformal, restarts
from pytest_tarl.monitoring.bet_updates import judged
from pytest_tarl.monitoring.moments import Moments
from pytest_tarl.monitoring.restarts import Processes
from pytest_tarl.monitoring.scores import WHOLE, Missions, Scale, binned, sampled, scale
from pytest_tarl.monitoring.stated import Bound, bounds
from pytest_tarl.seeds import generator
from pytest_tarl.sensors import Cell

PORTION = 512  # missions per scoring step
MOST_NEW = 256  # maximum number of cells to keep in `Monitor.new`
DRAWS = 4096  # random numbers per draw


@dataclass
class Counts:
    """Numbers of missions by kind."""

    missions: int = 0
    passed: int = 0
    without_steps: int = 0
    without_rewards: int = 0
    beyond_range: int = 0  # totals outside the declared range


@dataclass
class Monitor:
    """The state of a watch.

    The columns of `processes` are the bounds, followed by the scores; `pool` has shape (scores, BINS).
    """

    scale: Scale
    bounds: tuple[Bound, ...]
    alpha: float
    seed: int
    processes: Processes
    pool: Ints
    counts: Counts = field(default_factory=Counts)
    moments: Moments = field(default_factory=Moments)
    # cell that is not in the recording → number of missions that visited it
    new: dict[Cell, int] = field(default_factory=dict)
    drawn: tuple[int, NDArray[np.float64]] = (-1, np.empty(0))

    def observe(self, missions: Missions) -> None:
        """Update with missions in order; how they are batched makes no difference."""
        self.take(sampled(self.scale, missions), missions.time, missions.new)

    def take(self, sample: Sample, time: Floats, new: Sequence[Cell] = ()) -> None:
        """Update with missions in order; an unknown total is NaN, and `time`, of shape (missions,), is in seconds.

        Cells of the scale have their numbers in it. All other cells share the next number and are listed in `new`.
        """
        self.moments.add(self.counts.missions, time.tolist())
        self.judge(sample.passed, sample.total, binned(self.scale, sample))
        self._count(sample.steps, sample.total, new)

    def judge(self, passed: NDArray[np.bool_], total: Floats, bins: NDArray[np.integer[Any]]) -> None:
        """Update the processes; `bins` has shape (missions, scores)."""
        for begin in range(0, len(passed), conformal.TOGETHER):
            some = slice(begin, begin + conformal.TOGETHER)
            self._judge(passed[some], total[some], bins[some].astype(np.int64))

    def _judge(self, passed: NDArray[np.bool_], total: Floats, bins: Ints) -> None:
        """Update the processes with at most TOGETHER missions."""
        first, count = self.counts.missions, len(bins)
        one_robot = passed[:, None], total[:, None], bins[:, None, :]
        self.pool = judged(
            self.bounds, self.processes, self.pool, *one_robot, self.draws(first, count), first
        )
        self.counts.missions += len(bins)
        self.counts.passed += int(passed.sum())

    def draws(self, first: int, count: int) -> Floats:
        """Return a number in (0, 1] for breaking ties, for each of `count` missions from `first` on.

        They depend only on the seed and the index of the mission.
        """
        found = []
        for which in range(first // DRAWS, (first + count - 1) // DRAWS + 1):
            drawn = self.drawn  # read once, because several threads may use the monitor
            if drawn[0] != which:
                drawn = self.drawn = which, 1.0 - generator(self.seed, f"watch/{which}").random(DRAWS)
            begin = which * DRAWS
            found.append(drawn[1][max(0, first - begin) : max(0, first + count - begin)])
        return np.concatenate(found)

    def told(
        self,
        passed: NDArray[np.bool_],
        total: Floats,
        steps: Ints,
        time: Floats,
        new: Sequence[Cell] = (),
    ) -> None:
        """Count missions with which bet_updates.py already updated the processes; all arrays have shape (missions,)."""
        self.moments.add(self.counts.missions, time.tolist())
        self.counts.missions += len(passed)
        self.counts.passed += int(passed.sum())
        self._count(steps, total, new)

    def _count(self, steps: Ints, total: Floats, new: Sequence[Cell]) -> None:
        self.counts.without_steps += int((steps == 0).sum())
        self.counts.without_rewards += int((np.isnan(total) & (steps > 0)).sum())
        for bound in self.bounds:
            if bound.what == "total":
                outside = (total < bound.low) | (total > bound.high)
                self.counts.beyond_range += int(outside.sum())
        for cell in new:
            if cell in self.new or len(self.new) < MOST_NEW:
                self.new[cell] = self.new.get(cell, 0) + 1


def begun(fixture: Fixture, *, alpha: float, seed: int) -> Monitor:
    """Return a new monitor. Raise FixtureError if the recording has too few episodes."""
    how, held_out = scale(fixture)
    stated = bounds(fixture)
    scores = held_out.shape[1]
    pool = np.zeros((scores, conformal.BINS), np.int64)
    for row, column in enumerate(held_out.T):
        pool[row] = np.bincount(column[column >= 0], minlength=conformal.BINS)
    processes = restarts.begun(-np.log2(alpha * shares(len(stated), scores)))
    return Monitor(how, stated, alpha, seed, processes, pool)


def shares(stated: int, scores: int) -> Floats:
    """Return the shares of α, shape (processes,).

    Half of α goes to the bounds, if there are any. The rest is divided equally between the scores of whole missions and
    the scores of cells.
    """
    cells = scores - len(WHOLE)
    rest = 0.5 if stated else 1.0
    parts = [(stated, 0.5), (len(WHOLE), rest / 2 if cells else rest), (cells, rest / 2)]
    return np.concatenate([np.full(count, part / max(count, 1)) for count, part in parts])
