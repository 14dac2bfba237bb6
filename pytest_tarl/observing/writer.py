"""Convert an observer's messages to records of the log, in the writer process.

Columns, base64, JSON, compression and disk access all happen here, so the node's process never waits for them.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pytest_tarl.instrumentation.trace import Floats, Ints
from pytest_tarl.observing.log_format import LogFile, Record
from pytest_tarl.observing.stream import Chunk, Cut, chunk, merged
from pytest_tarl.sensors import Cell

MOST_HELD = 200_000  # approximate maximum number of entries (two per event) per record; limits memory


@dataclass(frozen=True)
class Rotation:
    """When to rotate a log: before a mission, once the log has `size` bytes.

    `keep` is the number of rotated files to keep, or 0 for all.
    """

    size: int = 0  # 0 for never
    keep: int = 0


class Writer:
    """Convert messages to records. A message is a tuple: its kind, then its parts."""

    def __init__(self, log: LogFile, about: Mapping[str, Any], rotation: Rotation) -> None:
        self._log = log
        self._about = about
        self._rotation = rotation
        self._cells: list[Cell] = []
        self._cuts: list[Cut] = []  # cuts of the current mission still to be written
        self._readings: list[list[Any]] = []
        self._times: list[float] = []
        self._changes: list[list[Any]] = []
        self._following = False
        self._dropped = 0
        self._held = 0  # number of entries in the cuts

    def take(self, message: tuple[Any, ...]) -> None:
        """Process one message; events may be held back until `sync` or `close`."""
        what, *parts = message
        getattr(self, f"_take_{what}")(*parts)

    def sync(self) -> None:
        """Write pending events and flush them to disk."""
        self._write_steps()
        self._log.sync()

    def close(self) -> None:
        """Sync, then close."""
        self._write_steps()
        self._log.close()

    def _take_start(self, time: float) -> None:
        self._log.append({"kind": "start", "time": time, **self._about})
        self._log.sync()

    def _take_cells(self, cells: list[Cell]) -> None:
        self._cells += map(tuple, cells)

    def _take_steps(
        self,
        cut: tuple[Any, ...],
        readings: list[Any],
        dropped: int,
        followed: tuple[list[float], list[list[Any]]] | None,
    ) -> None:
        self._cuts.append(Cut(*cut))
        self._held += sum(len(entries) for entries, _ in self._cuts[-1].threads)
        steps = len(self._cuts[-1].rewards)
        sensors = len(readings) // max(1, steps)
        self._readings += [readings[step * sensors : (step + 1) * sensors] for step in range(steps)]
        self._dropped = dropped
        if followed is not None:
            self._following = True
            self._times += followed[0]
            self._changes += followed[1]
        if self._held > MOST_HELD:
            self._write_steps()

    def _take_mission(self, time: float) -> None:
        self._write_steps()
        if self._rotation.size and self._log.size >= self._rotation.size:
            self._log.set_aside(self._rotation.keep)
            self._take_start(time)
        self._log.append({"kind": "mission", "time": time})

    def _take_end(self, record: Record) -> None:
        self._write_steps()
        self._log.append({"kind": "end", **record})

    def _write_steps(self) -> None:
        if not self._cuts:
            return
        record = steps_record(chunk(merged(self._cuts), self._cells), self._readings, self._dropped)
        if self._following:
            record |= {"times": self._times, "changes": self._changes}
        self._log.append(record)
        self._cuts, self._readings, self._times, self._changes = [], [], [], []
        self._held = 0


def steps_record(one: Chunk, readings: list[list[Any]], dropped: int) -> Record:
    """Return the record of some steps.

    The order of the fields must not change: the fast path of the watch relies on it (monitoring/log_blocks.py).
    """
    return {
        "kind": "steps",
        "cells": [list(cell) for cell in one.cells],
        "site": packed(one.site),
        "flow": packed(one.flow),
        "cell": packed(one.cell),
        "step": packed(one.step),
        "thread": packed(one.thread),
        "step_cell": packed(one.step_cell),
        "reward": packed(one.reward),
        "readings": readings,
        "dropped": dropped,
    }


def packed(column: Ints | Floats) -> str:
    """Return a column, shape (rows,), as base64 text of its little-endian bytes."""
    little = column.astype(column.dtype.newbyteorder("<"))
    return base64.b64encode(little.tobytes()).decode()


def unpacked(text: str, kind: str) -> Any:
    """Return a column from its text; `kind` is its numpy type."""
    return np.frombuffer(base64.b64decode(text), np.dtype(kind).newbyteorder("<")).astype(kind)
