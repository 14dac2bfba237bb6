"""Missions as they come out of a log, one by one, whoever else writes to it meanwhile."""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from binascii import a2b_base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.observing.frames import HEAD, MAGIC, Record, next_record
from pytest_tarl.sensors import Cell

LATEST = 1e11  # seconds since 1970: no clock of a robot is further
_DECODED = json.JSONDecoder().raw_decode


class Progress(NamedTuple):
    """How far a log was read: up to `offset`, where the record at `last` ends, whose length and checksum is `mark`.

    The log is known by its first record, so that it is the same one under another name. `refused` tells why missions
    at the offset are not comparable with the fixture, as a sentence.
    """

    log: str
    path: str
    offset: int
    last: int
    mark: str
    refused: str = ""
    missions: int = 0
    unfinished: int = 0  # missions that began and did not end before the next one began


@dataclass(frozen=True)
class Table:
    """The cells that a record's steps refer to: their rows, -1 at last, and those that the fixture does not know."""

    cells: list[Any]
    rows: Ints
    new: Sequence[Cell | None]  # None where the fixture knows the cell; empty where it knows all


class Steps(NamedTuple):
    """Some steps of a mission as they stand in the log: little-endian columns, int32 and float64."""

    table: Table
    cell: bytes
    reward: bytes


class Mission(NamedTuple):
    """A mission that has ended, its cells that the fixture does not know, and how far its log was read with it."""

    passed: bool
    time: float
    steps: tuple[Steps, ...]
    new: tuple[Cell, ...]
    progress: Progress


@dataclass(frozen=True)
class Expected:
    """What a log must have been written with to be of one kind with the fixture."""

    test: str
    sensors: tuple[str, ...]
    digest: str
    number: Mapping[Cell, int]

    def problem(self, start: Record, path: Path) -> str:
        """Return why missions after this record are not comparable, as a sentence; empty where they are."""
        names = start.get("sensors", [])
        if [*names] != [*self.sensors]:
            return (
                f"{path} was written with the sensors {', '.join(map(str, names))}, the fixture of {self.test} has "
                f"{', '.join(self.sensors)}: its missions are not counted. Watch it with its own fixture."
            )
        if start.get("test", self.test) != self.test:
            return (
                f"{path} was written for the fixture of {start['test']}, not of {self.test}: its missions are not "
                "counted. Watch it with its own fixture."
            )
        if start.get("bins", self.digest) != self.digest:
            return (
                f"{path} was written when the sensors of {self.test} had other bins: its missions are not counted. "
                "Observe again with the fixture as it is now."
            )
        return ""


@dataclass
class LogReader:
    """One log that may grow, be rotated, cut short or not be there yet; `problem` tells what is wrong with it now."""

    path: Path
    expected: Expected
    known: Mapping[str, Progress]  # of all logs that were ever counted
    owners: dict[str, Path]  # where the logs were found that are open now
    problem: str = ""
    _file: BinaryIO | None = None
    _at: Progress = field(default_factory=lambda: Progress("", "", 0, -1, ""))
    _place: int = 0  # what was read of the file; a mission that has not ended lies between `_at` and it
    _latest: tuple[int, bytes] | None = None  # the record that ends there, and where it begins
    _begun: tuple[float, list[Steps]] | None = None
    _table: Table = field(default_factory=lambda: Table([], np.array([-1]), ()))

    def missions(self) -> Iterator[Mission]:
        """Yield the missions that have ended since the last time.

        A rotated log is read to its end before the one that took its name.
        """
        while True:
            if self._file is None and not self._open():
                return
            yield from self._read()
            if not self._rotated():
                return
            self.close()

    def close(self) -> None:
        """Close the file; reading goes on where `known` says."""
        if self._file is not None:
            self._file.close()
            self.owners.pop(self._at.log, None)
        self._file = self._begun = self._latest = None

    def _open(self) -> bool:
        try:
            file = self.path.open("rb")
        except FileNotFoundError:
            self.problem = f"{self.path} is not there yet."
            return False
        except OSError as problem:
            self.problem = f"{self.path} cannot be read ({problem.strerror}): look at the path."
            return False
        if self._begin(file):
            self._file = file
            return True
        file.close()
        return False

    def _begin(self, file: BinaryIO) -> bool:
        """Find out which log this is and where to go on. Return whether there is anything to read."""
        magic = file.read(len(MAGIC))
        if not MAGIC.startswith(magic):
            self.problem = (
                f"{self.path} is no log of `tarl observe`, or one of another version: name such a log."
            )
            return False
        self.problem = ""
        first = next_record(file) if magic == MAGIC else None
        if first is None:
            return False  # nothing was written yet
        log = hashlib.sha256(first).hexdigest()[:16]
        if log in self.owners:
            self.problem = (
                f"{self.path} is the same log as {self.owners[log]}: its missions are counted once."
            )
            return False
        fresh = Progress(log, str(self.path), len(MAGIC), -1, "")
        at = self.known.get(log, fresh)._replace(path=str(self.path))
        if at.last >= 0 and not _unchanged(file, at):
            self.problem = (
                f"{self.path} was cut short or changed since it was read up to byte {at.offset}: nothing more of it is "
                "counted. Restore it, or have the node write a new log."
            )
            return False
        self._at, self._place, self.problem = at, at.offset, at.refused
        self.owners[log] = self.path
        return True

    def _rotated(self) -> bool:
        """Tell whether another file has the log's name by now, or the log got shorter than what was read of it."""
        if self._file is None:
            return False
        mine = os.fstat(self._file.fileno())
        try:
            there = self.path.stat()
        except OSError:
            return False
        return (mine.st_ino, mine.st_dev) != (there.st_ino, there.st_dev) or mine.st_size < self._at.offset

    def _read(self) -> Iterator[Mission]:
        """Yield missions up to the last whole record; one that has not ended is kept for the next time."""
        file = self._file
        if file is None:
            return
        file.seek(self._place)
        while (payload := next_record(file)) is not None:
            before, self._latest = self._latest, (self._place, payload)
            self._place += HEAD + len(payload)
            mission = self._take(_DECODED(zlib.decompress(payload).decode())[0], before)
            if mission is not None:
                yield mission
        self._damaged(file, self._place)

    def _take(self, record: Record, before: tuple[int, bytes] | None) -> Mission | None:
        """Take one record; return the mission that ends with it. `before` is the record before it, if it was read."""
        kind, at = record["kind"], self._at
        if kind == "steps":
            if self._begun is not None:
                self._begun[1].append(self._steps(record))
            return None
        begun, self._begun = self._begun, None
        if kind == "mission":
            time = float(record["time"])
            self._begun = (time if 0.0 <= time < LATEST else 0.0), []
            if begun is None and (before is None or before[0] == at.last):
                return None  # it begins where the last one ended
        refused, ended = at.refused, kind == "end" and begun is not None
        if kind == "start":
            refused = self.problem = self.expected.problem(record, self.path)
        last = before if kind == "mission" else self._latest
        offset, place, mark = at.offset, at.last, at.mark
        if last is not None:
            place, payload = last
            offset, mark = place + HEAD + len(payload), _mark(payload)
        unfinished = at.unfinished + (begun is not None and not ended and not at.refused)
        counted = at.missions + (ended and not refused)
        self._at = at = Progress(at.log, at.path, offset, place, mark, refused, counted, unfinished)
        if begun is None or not ended or refused:
            return None
        return Mission(bool(record["passed"]), begun[0], tuple(begun[1]), _new(begun[1]), at)

    def _steps(self, record: Record) -> Steps:
        if record["cells"] != self._table.cells:
            number = self.expected.number
            named = [tuple(cell) for cell in record["cells"]]
            rows = np.array([*(number.get(cell, len(number)) for cell in named), -1], np.int64)
            new = [None if cell in number else cell for cell in named]
            self._table = Table(record["cells"], rows, [*new, None] if any(new) else ())
        return Steps(self._table, a2b_base64(record["step_cell"]), a2b_base64(record["reward"]))

    def _damaged(self, file: BinaryIO, place: int) -> None:
        """Notice a record that is there in full and yet not readable."""
        rest = os.fstat(file.fileno()).st_size - place
        file.seek(place)
        head = file.read(4)
        if len(head) == 4 and 8 + int.from_bytes(head, "little") < rest:
            self.problem = (
                f"{self.path} is damaged at byte {place}: what comes after it is not counted. Have the node write "
                "a new log."
            )


def columns(missions: Sequence[Mission]) -> tuple[Ints, Floats]:
    """Return the row of the cell and the reward of every step of all missions."""
    cells: list[Ints] = []
    for table, steps in groupby(
        (one for mission in missions for one in mission.steps), lambda one: one.table
    ):
        cells.append(table.rows[np.frombuffer(b"".join(one.cell for one in steps), "<i4")])
    reward = np.frombuffer(b"".join(one.reward for mission in missions for one in mission.steps), "<f8")
    return np.concatenate([np.empty(0, np.int64), *cells]), reward.astype(np.float64)


def _new(steps: Sequence[Steps]) -> tuple[Cell, ...]:
    found: set[Cell] = set()
    for one in steps:
        if one.table.new:
            here = set(np.frombuffer(one.cell, "<i4").tolist())
            found.update(cell for place in here if (cell := one.table.new[place]) is not None)
    return tuple(sorted(found))


def _unchanged(file: BinaryIO, at: Progress) -> bool:
    """Tell whether the last record that was read is still where it was."""
    file.seek(at.last)
    payload = next_record(file)
    return payload is not None and file.tell() == at.offset and _mark(payload) == at.mark


def _mark(payload: bytes) -> str:
    return f"{len(payload)}:{zlib.crc32(payload)}"
