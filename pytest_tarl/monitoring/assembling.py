"""Assemble missions from the records of a log.

A mission is one run of the robot, from a `mission` record to an `end` record.
"""

from __future__ import annotations

import json
from binascii import a2b_base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pytest_tarl.monitoring.log_blocks import AtOnce, Block, Spot, end_of
from pytest_tarl.monitoring.mission import Mission, Progress, Steps, Table, advanced
from pytest_tarl.observing.log_format import Record
from pytest_tarl.sensors import Cell

LATEST = 1e11  # seconds since 1970; a later time means that the clock is wrong


@dataclass(frozen=True)
class Expected:
    """The test and the sensors that a log must have."""

    test: str
    sensors: tuple[str, ...]
    digest: str
    number: Mapping[Cell, int]

    def problem(self, start: Record, path: Path) -> str:
        """Return why missions after the record `start` cannot be compared, or an empty text."""
        names = start.get("sensors", [])
        if [*names] != [*self.sensors]:
            return (
                f"{path} was written with the sensors {', '.join(map(str, names))}, but the recording of {self.test} "
                f"has {', '.join(self.sensors)}: its missions are not counted. Name the recording for "
                "which it was written."
            )
        if start.get("test", self.test) != self.test:
            return (
                f"{path} was written for the recording of {start['test']}, not of {self.test}: its missions are not "
                "counted. Name the recording for which it was written."
            )
        if start.get("bins", self.digest) != self.digest:
            return (
                f"{path} was written when the sensors of {self.test} had other bins: its missions are not counted. "
                "Run `tarl observe` again with the current recording."
            )
        return ""


@dataclass
class Assembly:
    """The state of reading a log, including its unfinished mission."""

    expected: Expected
    path: Path
    # the progress when the log was opened; its `refused` says why later missions are not counted
    begun: Progress
    place: int
    missions: int = 0
    unfinished: int = 0
    # the last record of the latest mission, or a later record outside any mission
    _last: Spot | None = None
    _latest: Spot | None = None  # the last record read
    # start time (seconds since 1970) and steps of the unfinished mission
    _mission: tuple[float, list[Steps]] | None = None
    _table: Table = field(default_factory=lambda: Table([], np.array([-1]), ()))
    _text: bytes = b""  # JSON that `_table` was read from, if it came from a mission in consecutive records

    @property
    def progress(self) -> Progress:
        """Return the progress after the last complete mission."""
        return advanced(self.begun, self._last, self.missions, self.unfinished)

    def of_block(self, block: Block) -> Iterator[Mission]:
        """Yield the missions that end in the block; stop at an invalid record."""
        while block.left():
            if self._mission is None and self._latest == self._last and not self.begun.refused:
                for found in block.at_once():
                    yield self._at_once(found)
                if not block.left():
                    return
            try:
                record = block.record()
            except ValueError:
                return
            before, self._latest = self._latest, block.spot()
            self.place = end_of(self._latest)
            if record["kind"] == "steps":
                if self._mission is not None:
                    self._mission[1].append(
                        self._steps(record["cells"], record["step_cell"], record["reward"])
                    )
            elif record["kind"] == "end" and self._mission is not None and not self.begun.refused:
                time, steps = self._mission
                yield self._ended(bool(record["passed"]), time, steps, self._latest)
            else:
                self._take(record, before)

    def _at_once(self, found: AtOnce) -> Mission:
        time, cells, cell, reward, passed, spot = found
        self._latest, self.place = spot, end_of(spot)
        if cells == self._text:
            steps = self._table, a2b_base64(cell), a2b_base64(reward)
        else:
            steps = self._steps(json.loads(cells), cell, reward)
            self._text = cells
        return self._ended(passed == b"true", valid_time(time), [steps], spot)

    def _ended(self, passed: bool, time: float, steps: list[Steps], spot: Spot) -> Mission:
        """Return the mission that ends with the `end` record at this spot."""
        self._mission, self._last, self.missions = None, spot, self.missions + 1
        new = _new(steps) if any(table.new for table, _, _ in steps) else ()
        return Mission(passed, time, steps, new, self.begun, spot, self.missions, self.unfinished)

    def _take(self, record: Record, before: Spot | None) -> None:
        """Process a record that does not end a counted mission."""
        kind, last, refused = record["kind"], self._latest, self.begun.refused
        torn, self._mission = self._mission is not None and kind != "end", None
        if kind == "mission":
            self._mission = valid_time(record["time"]), []
            if not torn and (before is None or before == self._last):
                return  # nothing was lost: this mission starts directly after the previous one
            last = before
        elif kind == "start":
            self.begun = self.begun._replace(refused=self.expected.problem(record, self.path))
        self._last = last
        self.unfinished += torn and not refused

    def _steps(self, cells: list[Any], cell: str | bytes, reward: str | bytes) -> Steps:
        if cells != self._table.cells:
            number = self.expected.number
            named = [tuple(one) for one in cells]
            rows = np.array([*(number.get(one, len(number)) for one in named), -1], np.int64)
            new = [None if one in number else one for one in named]
            self._table, self._text = Table(cells, rows, [*new, None] if any(new) else ()), b""
        return self._table, a2b_base64(cell), a2b_base64(reward)


def _new(steps: Sequence[Steps]) -> tuple[Cell, ...]:
    found: set[Cell] = set()
    for table, cell, _ in steps:
        if table.new:
            here = set(np.frombuffer(cell, "<i4").tolist())
            found.update(one for place in here if (one := table.new[place]) is not None)
    return tuple(sorted(found))


def valid_time(told: float | bytes) -> float:
    """Return the time in seconds since 1970, or 0 if the clock was wrong."""
    time = float(told)
    return time if 0.0 <= time < LATEST else 0.0
