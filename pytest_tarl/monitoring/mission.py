"""A mission read from a log, and the position in the log after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring.blocks import Spot, end_of
from pytest_tarl.sensors import Cell


class Progress(NamedTuple):
    """How far a log was read: up to `offset`, where the record at `last` ends, whose length and checksum is `mark`.

    The log is identified by its first record, even after renaming. `refused` is a sentence on why missions at the
    offset are not comparable with the recording.
    """

    log: str
    path: str
    offset: int
    last: int
    mark: str
    refused: str = ""
    missions: int = 0
    unfinished: int = 0  # missions without an end before the next one began


@dataclass(frozen=True)
class Table:
    """The cells that a record's steps refer to: their rows, -1 at last, and those that the fixture does not know."""

    cells: list[Any]
    rows: Ints
    new: Sequence[Cell | None]  # None where the fixture knows the cell; empty where it knows all


# Some steps of a mission as they stand in the log: cells and rewards are little-endian columns, int32 and float64
Steps = tuple[Table, bytes, bytes]


class Mission(NamedTuple):
    """A mission that has ended, its cells that the fixture does not know, and how far its log was read with it.

    That is since `begun`, when the log was opened, up to the record at `last`.
    """

    passed: bool
    time: float
    steps: Sequence[Steps]
    new: tuple[Cell, ...]
    begun: Progress
    last: Spot
    missions: int
    unfinished: int

    @property
    def progress(self) -> Progress:
        """Return how far its log was read with it."""
        return advanced(self.begun, self.last, self.missions, self.unfinished)


def advanced(begun: Progress, last: Spot | None, missions: int, unfinished: int) -> Progress:
    """Return how far a log was read since `begun`, with the record at `last`; None if with none."""
    counted = begun._replace(missions=missions, unfinished=unfinished)
    if last is None:
        return counted
    return counted._replace(offset=end_of(last), last=last[0], mark=mark(last))


def mark(spot: Spot) -> str:
    """Return what a record is known by."""
    _, length, checksum = spot
    return f"{length}:{checksum}"


def columns(missions: Sequence[Mission]) -> tuple[Ints, Ints, Floats]:
    """Return the mission of every step of all missions, by its place, the row of its cell, and its reward."""
    pieces = [one for mission in missions for one in mission.steps]
    reward = np.frombuffer(b"".join([rewards for _, _, rewards in pieces]), "<f8").astype(np.float64)
    owner = np.repeat(np.arange(len(missions)), [len(mission.steps) for mission in missions])
    cells = [np.empty(0, np.int64)]
    for table, some in groupby(pieces, lambda one: one[0]):
        cells.append(table.rows[np.frombuffer(b"".join([cell for _, cell, _ in some]), "<i4")])
    sizes = [len(rewards) // reward.itemsize for _, _, rewards in pieces]
    return np.repeat(owner, sizes), np.concatenate(cells), reward


def latest(missions: Sequence[Mission]) -> dict[str, Progress]:
    """Return how far each log was read with its last mission, by its first record."""
    last = {one.begun.log: one for one in missions}
    return {log: one.progress for log, one in last.items()}
