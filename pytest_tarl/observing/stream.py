"""A recorder that is emptied while the node runs, so that memory stays bounded however long a mission lasts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pytest_tarl.instrumentation.events import paired, sizes
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.instrumentation.trace import Floats, Ints
from pytest_tarl.sensors import Cell

MOST_ENTRIES = 4_000_000  # halves of events that wait for the disk; beyond, they are dropped and counted


@dataclass(frozen=True)
class Chunk:
    """What happened between two emptyings.

    Event columns have shape (events,), step columns (steps,); `step` counts from the first step of the chunk, and
    events after its last reward belong to a step that the next chunk closes.
    """

    cells: tuple[Cell, ...]
    site: Ints
    flow: Floats
    cell: Ints
    step: Ints
    thread: Ints
    step_cell: Ints
    reward: Floats

    @property
    def empty(self) -> bool:
        """Tell whether there is nothing to write."""
        return not self.site.size and not self.reward.size


class Stream(Recorder):
    """Record without end: `drain` takes what is there."""

    _packing = False  # from any thread, so no other may

    def __init__(self) -> None:
        super().__init__(threads=True)
        self.dropped = 0

    def drain(self) -> Chunk:
        """Return what was recorded since the last time, and forget it. From any thread."""
        with self._lock:
            latched, rewards, totals = self._latched, self._rewards, self._totals
            self._latched, self._rewards, self._totals, self._parts = latched[-1:], [], [], []
            cut = []
            for buffer in self._buffers:
                entries = _cut(buffer.entries)
                cut.append((entries, [min(length, len(entries)) for length in buffer.lengths]))
                buffer.lengths = [0] * len(self._latched)
            cells = tuple(self._cells)
        columns = [_columns(entries, lengths, latched, rewards) for entries, lengths in cut]
        threads = [np.full(len(column[0]), number, np.int32) for number, column in enumerate(columns)]
        site, flow, cell, step = (np.concatenate(part) for part in zip(*columns, strict=True))
        thread = np.concatenate(threads)
        order = np.lexsort((thread, step))
        step_cell = np.array(latched, np.int32)[rewards]
        return Chunk(
            cells,
            site[order],
            flow[order],
            cell[order],
            step[order],
            thread[order],
            step_cell,
            np.array(totals, np.float64),
        )

    def relieve(self) -> None:
        """Drop events when so many wait that memory would run out; `dropped` counts them."""
        for buffer in tuple(self._buffers):
            if len(buffer.entries) > MOST_ENTRIES:
                with self._lock:
                    lost = _cut(buffer.entries)
                    buffer.lengths = [0] * len(buffer.lengths)
                self.dropped += len(lost) // 2


def _cut(entries: list[Any]) -> list[Any]:
    """Take whole events off the front; the owner may be appending. Each of the three operations is atomic."""
    count = len(entries)
    if count and type(entries[count - 1]) is int:
        count -= 1  # a site whose value is still to come
    taken = entries[:count]
    del entries[:count]
    return taken


def _columns(
    entries: list[Any], lengths: list[int], latched: list[int], rewards: list[int]
) -> tuple[Ints, Floats, Ints, Ints]:
    """Return site, flow, cell and step of every event of one thread."""
    site, flow, starts = paired(entries)
    before = np.searchsorted(starts, np.array(lengths, np.int64), side="left")
    between = np.diff(before, prepend=0, append=len(starts))
    cells = np.array([-1, *latched], np.int32)
    closing = np.zeros(len(cells), np.int32)
    closing[np.array(rewards, np.int64) + 1] = 1
    steps = np.cumsum(closing).astype(np.int32)
    return site, sizes(flow), np.repeat(cells, between), np.repeat(steps, between)
