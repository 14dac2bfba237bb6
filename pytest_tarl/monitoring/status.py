"""The status of a monitor: evidence, onsets and changed cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pytest_tarl.learning.tables import Ints
from pytest_tarl.monitoring import e_bh, e_process, restarts
from pytest_tarl.monitoring.monitor import Monitor
from pytest_tarl.monitoring.scores import WHOLE
from pytest_tarl.monitoring.stated import Bound
from pytest_tarl.sensors import Cell

# indices of the bets on low and on high ranks; the other bets are on both extremes
LOW, HIGH = (0, 1, 2, 3, 10), (4, 5, 6, 7, 11)
FEWEST_NEW = 2  # a new cell is listed if at least this many missions visited it


@dataclass(frozen=True)
class Moment:
    """The number of a mission (from 1), and its start in seconds since 1970 or None."""

    mission: int
    time: float | None


@dataclass(frozen=True)
class Evidence:
    """The current and largest evidence against a hypothesis, as log10; -log10(α) raises an alarm.

    The difference probably began just before mission `since`. `alarm` is the mission that raised the alarm.
    """

    now: float
    highest: float
    since: Moment | None
    alarm: Moment | None


@dataclass(frozen=True)
class Score:
    """A score of missions or of a cell, and the direction of its change."""

    name: str
    cell: Cell | None
    side: str  # "lower", "higher", "spread"


@dataclass(frozen=True)
class Status:
    """The status of a watch; bounds that cannot be violated have no evidence."""

    missions: int
    passed: int
    alpha: float
    bounds: tuple[tuple[Bound, Evidence | None], ...]
    world: Evidence
    lead: Score | None
    cells: tuple[Cell, ...]
    new: tuple[Cell, ...]
    notes: tuple[str, ...] = ()

    @property
    def below(self) -> bool:
        """Return whether an alarm was raised because missions violate a bound."""
        return any(evidence is not None and evidence.alarm is not None for _, evidence in self.bounds)

    @property
    def drifted(self) -> bool:
        """Return whether an alarm was raised because missions differ from the recorded ones."""
        return self.world.alarm is not None

    @property
    def alarm(self) -> bool:
        """Return whether an alarm was ever raised; alarms are final."""
        return self.below or self.drifted

    @property
    def error(self) -> float:
        """Return the probability of any false alarm or wrong bound."""
        stated = {1.0 - bound.confidence for bound, evidence in self.bounds if evidence is not None}
        return self.alpha + (
            len([one for one in self.bounds if one[1] is not None]) * max(stated, default=0.0)
        )


def status(monitor: Monitor) -> Status:
    """Return the status of a monitor."""
    processes, stated = monitor.processes, len(monitor.bounds)
    scores = np.arange(stated, processes.count)
    active = scores[processes.age[scores] > 0]
    world = _evidence(monitor, active if active.size else scores[:1])
    return Status(
        missions=monitor.counts.missions,
        passed=monitor.counts.passed,
        alpha=monitor.alpha,
        bounds=tuple(
            (bound, _evidence(monitor, np.array([row])) if _testable(bound) else None)
            for row, bound in enumerate(monitor.bounds)
        ),
        world=world,
        lead=_lead(monitor, active),
        cells=_region(monitor) if world.alarm else (),
        new=tuple(sorted(cell for cell, count in monitor.new.items() if count >= FEWEST_NEW)),
        notes=tuple(_notes(monitor)),
    )


def _testable(bound: Bound) -> bool:
    return e_process.testable(float(bound.share(bound.least)))


def _evidence(monitor: Monitor, rows: Ints) -> Evidence:
    """Return the largest evidence in these rows, relative to α."""
    processes = monitor.processes
    unit = -processes.threshold[rows] - np.log2(monitor.alpha)
    now = restarts.log_evidence(processes)[rows] + unit
    peak = processes.peak[rows] + unit
    row = int(rows[np.argmax(peak)])
    raised = processes.alarm[rows]
    raised = raised[raised >= 0]
    known = bool(processes.age[row])
    return Evidence(
        now=float(now.max() * np.log10(2.0)),
        highest=float(peak.max() * np.log10(2.0)),
        since=_moment(monitor, int(processes.onset[row])) if known else None,
        alarm=_moment(monitor, int(raised.min())) if raised.size else None,
    )


def _moment(monitor: Monitor, number: int) -> Moment:
    return Moment(number + 1, monitor.moments.at(number))


def _lead(monitor: Monitor, rows: Ints) -> Score | None:
    """Return the score with the most evidence, or None."""
    if not rows.size:
        return None
    processes = monitor.processes
    row = int(rows[np.argmax(processes.peak[rows] - processes.threshold[rows])])
    bet = int(np.argmax(processes.best[:, row]))
    side = "lower" if bet in LOW else "higher" if bet in HIGH else "spread"
    place = row - len(monitor.bounds)
    if place < len(WHOLE):
        return Score(WHOLE[place], None, side)
    return Score("residual", monitor.scale.cells[place - len(WHOLE)], side)


def _region(monitor: Monitor) -> tuple[Cell, ...]:
    """Return the cells in which missions differ from recorded ones, according to e-BH."""
    peaks = monitor.processes.peak[len(monitor.bounds) + len(WHOLE) :]
    picked = e_bh.chosen(e_bh.adjusted(peaks), monitor.alpha)
    return tuple(monitor.scale.cells[row] for row in np.flatnonzero(picked).tolist())


def _notes(monitor: Monitor) -> list[str]:
    counts, notes = monitor.counts, []
    if not monitor.bounds:
        notes.append("All episodes of the recording are equal, so it has no bound to test.")
    if counts.without_steps:
        notes.append(f"{_missions(counts.without_steps)} without a step: only success was judged.")
    if counts.without_rewards:
        notes.append(
            f"{_missions(counts.without_rewards)} without rewards (written with --step): totals were not judged."
        )
    if counts.beyond_range:
        notes.append(
            f"{_missions(counts.beyond_range)} with a total outside the declared range: clipped to its ends, so "
            "evidence on the mean refers to clipped totals."
        )
    return notes


def _missions(count: int) -> str:
    return f"{count:,} mission{'s' if count != 1 else ''}"
