"""A mission read from a log, and how far the log was read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from pytest_tarl.learning.tables import Floats, Ints
from pytest_tarl.monitoring.log_blocks import Spot, end_of
from pytest_tarl.sensors import Cell


class Progress(NamedTuple):
    """How far a log was read: up to `offset`.

    The last record read starts at offset `last`; `mark` identifies it by length and checksum. `log` identifies the log
    by its first record, so that a renamed log is recognised. `refused` says why later missions cannot be compared with
    the recording; it is empty if they can.
    """

    log: str
    path: str
    offset: int
    last: int
    mark: str
    refused: str = ""
    missions: int = 0
    unfinished: int = 0  # number of missions without an `end` record


@dataclass(frozen=True, eq=False)
class Table:
    """The cells of a `steps` record; `rows` are their rows in the recording, or -1.

    `new` has the cells that are not in the recording. Tables are compared by identity, because comparing arrays does
    not give a single truth value.
    """

    cells: list[Any]
    rows: Ints
    new: Sequence[Cell | None]  # None for known cells; empty if all are known


# the steps of a mission in the log: cells as little-endian int32, rewards as float64
Steps = tuple[Table, bytes, bytes]


class Mission(NamedTuple):
    """A finished mission, with its new cells and the progress of the log.

    This run started to read the log at `begun`, and has read up to the record at `last`.
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
        """Return the log's progress after this mission."""
        return advanced(self.begun, self.last, self.missions, self.unfinished)


def advanced(begun: Progress, last: Spot | None, missions: int, unfinished: int) -> Progress:
    """Return the progress `begun` with new counts and, if `last` is given, moved to that record."""
    counted = begun._replace(missions=missions, unfinished=unfinished)
    if last is None:
        return counted
    return counted._replace(offset=end_of(last), last=last[0], mark=mark(last))


def mark(spot: Spot) -> str:
    """Return a string that identifies a record by length and checksum."""
    _, length, checksum = spot
    return f"{length}:{checksum}"


def columns(missions: Sequence[Mission]) -> tuple[Ints, Ints, Floats]:
    """Return the mission, cell row and reward of every step, each of shape (steps,)."""
    pieces = [one for mission in missions for one in mission.steps]
    reward = np.frombuffer(b"".join([rewards for _, _, rewards in pieces]), "<f8").astype(np.float64)
    owner = np.repeat(np.arange(len(missions)), [len(mission.steps) for mission in missions])
    cells = [np.empty(0, np.int64)]
    for table, some in groupby(pieces, lambda one: one[0]):
        cells.append(table.rows[np.frombuffer(b"".join([cell for _, cell, _ in some]), "<i4")])
    sizes = [len(rewards) // reward.itemsize for _, _, rewards in pieces]
    return np.repeat(owner, sizes), np.concatenate(cells), reward


def latest(missions: Sequence[Mission]) -> dict[str, Progress]:
    """Return log ID → progress after that log's last mission."""
    last = {one.begun.log: one for one in missions}
    return {log: one.progress for log, one in last.items()}
