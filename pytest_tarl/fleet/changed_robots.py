"""Find the robots whose world differs from the recorded one, and when the difference began.

Each robot has its own monitor, as in `tarl watch`. Evidence against a hypothesis is measured by e-values: an e-value is
at most 1 on average if the hypothesis is true.

Each process of a monitor has two e-values:

- Its last value. It is large if the robot still differs. It is an e-value if the number of missions does not depend on
  their results.
- Its adjusted running maximum (monitoring/e_bh.py). It is large if the robot differed at any time. It is an e-value at
  any time.

The mean of the two is averaged over the processes, weighted by their shares of α; the result is again an e-value. e-BH
over the robots keeps the expected share of false reports at or below q, even if robots depend on each other. All
monitors may therefore use the same recording. For bounds, the expected share may be larger than q by the probability
that a recorded bound is wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pytest_tarl.fleet import side_by_side
from pytest_tarl.fleet.dask_tasks import Engine
from pytest_tarl.fleet.database import Database
from pytest_tarl.fleet.scores import Scores
from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring import e_bh, e_process, restarts
from pytest_tarl.monitoring.moments import Moments
from pytest_tarl.monitoring.monitor import Counts, Monitor, shares
from pytest_tarl.monitoring.status import Evidence, Status
from pytest_tarl.monitoring.status import status as status_of

PORTION = 50_000  # number of missions judged in one task


@dataclass(frozen=True)
class Robot:
    """The evidence on one robot, as log2 of e-values: that its world differs, and that it violates a bound.

    `status` is None if both e-values are below 1/q, which is the least that e-BH needs to reject a hypothesis.
    """

    name: str
    missions: int
    passed: int
    world: float
    bound: float
    status: Status | None


@dataclass(frozen=True)
class Robots:
    """All robots by name, and those that e-BH reports at false discovery rate `q`."""

    q: float
    every: tuple[Robot, ...]
    drifted: tuple[Robot, ...]
    below: tuple[Robot, ...]


def judged(database: Database, first: Monitor, scores: Scores, engine: Engine, q: float) -> Robots:
    """Judge each robot's missions in order of time, starting from a copy of the monitor `first`."""
    rows = database.columns(
        "SELECT any_value(robot) AS robot, max(number) + 1 AS ends FROM missions GROUP BY robot_number ORDER BY ends"
    )
    return named(tuple(watched(first, scores, rows["robot"], rows["ends"], engine, q)), q)


def watched(
    first: Monitor, scores: Scores, names: Sequence[str], ends: object, engine: Engine, q: float
) -> Iterator[Robot]:
    """Yield the evidence on each robot. Robot n has missions `ends[n - 1]` to `ends[n]` - 1."""
    every: Ints = np.asarray(ends).astype(np.int64)
    some = list(portions(every))

    def tasks() -> Iterator[tuple[object, ...]]:
        begin, place = 0, 0
        for portion in some:
            own = [str(one) for one in names[place : place + portion.size]]
            yield first, scores.between(begin, int(portion[-1])), portion - begin, own, q
            begin, place = int(portion[-1]), place + portion.size

    for found in engine.each(portioned, tasks()):
        yield from found


def named(every: tuple[Robot, ...], q: float) -> Robots:
    """Return all robots, and the robots that e-BH reports."""
    return Robots(
        q=q,
        every=every,
        drifted=_chosen(every, [one.world for one in every], q),
        below=_chosen(every, [one.bound for one in every], q),
    )


def _chosen(every: Sequence[Robot], evidence: Sequence[float], q: float) -> tuple[Robot, ...]:
    picked = np.flatnonzero(e_bh.chosen(np.array(evidence, np.float64), q)).tolist()
    return tuple(every[n] for n in sorted(picked, key=lambda n: (-evidence[n], every[n].name)))


def portioned(first: Monitor, scores: Scores, ends: Ints, names: Sequence[str], q: float) -> list[Robot]:
    """Judge robots and return them in order; the missions of robot n are `ends[n - 1]` to `ends[n]` - 1.

    `ends` has shape (robots,).

    If a robot has enough evidence for a status, its missions are judged a second time to find the onset.
    """
    found: dict[int, Robot] = {}
    for some in side_by_side.watched(first, scores, ends, onsets=False):
        both = zip(some.robots.tolist(), some.peaks(), some.latest(), strict=True)
        for number, peak, latest in both:
            low, high = int(ends[number - 1]) if number else 0, int(ends[number])
            passed = int(np.count_nonzero(scores.passed[low:high]))
            found[number] = Robot(
                names[number], high - low, passed, *evidence(first, peak, latest), status=None
            )
    reached = [number for number, one in found.items() if max(one.world, one.bound) >= -np.log2(q)]
    for some in side_by_side.watched(first, scores, ends, np.array(sorted(reached), np.int64)):
        for place, number in enumerate(some.robots.tolist()):
            monitor = fresh(first)
            monitor.processes, monitor.pool = some.state(place)
            own = scores.between(int(ends[number - 1]) if number else 0, int(ends[number]))
            monitor.told(own.passed, own.total, own.steps, own.time, own.new())
            found[number] = replace(found[number], status=status_of(monitor))
    return [found[number] for number in range(len(ends))]


def portions(ends: Ints) -> Iterator[Ints]:
    """Divide robots into portions of about PORTION missions; yield the `ends` of each portion.

    The missions of robot n end before mission `ends[n]`; `ends` has shape (robots,).
    """
    which = (ends - 1) // PORTION
    for one in np.unique(which).tolist():
        yield ends[which == one]


def fresh(first: Monitor) -> Monitor:
    """Return a new monitor of the same recording, with no missions."""
    processes = restarts.begun(first.processes.threshold)
    return replace(first, processes=processes, counts=Counts(), moments=Moments(), new={})


def evidence(monitor: Monitor, peak: Floats, latest: Floats) -> tuple[float, float]:
    """Return, as log2 of e-values, the evidence that missions differ and that they violate a bound.

    `peak` and `latest`, of shape (processes,), are log2 of each process's largest and last evidence.
    """
    stated = len(monitor.bounds)
    each = np.logaddexp2(e_bh.adjusted(peak), latest) - 1.0
    weight = shares(stated, len(peak) - stated)
    testable = np.array([e_process.testable(float(one.share(one.least))) for one in monitor.bounds], bool)
    world = _mean(each[stated:], weight[stated:])
    return world, _mean(each[:stated][testable], weight[:stated][testable])


def _mean(log_evidence: np.ndarray[tuple[int], np.dtype[np.float64]], weight: object) -> float:
    """Return log2 of the weighted mean of e-values; -1 if there are none."""
    if not log_evidence.size:
        return -1.0
    share = np.asarray(weight, np.float64)
    largest = float(log_evidence.max())
    return largest + float(np.log2(np.exp2(log_evidence - largest) @ (share / share.sum())))


def lower(found: Status) -> Evidence | None:
    """Return the strongest evidence against a bound, or None if no bound can be tested."""
    told = [evidence for _, evidence in found.bounds if evidence is not None]
    return max(told, key=lambda evidence: evidence.highest, default=None)
