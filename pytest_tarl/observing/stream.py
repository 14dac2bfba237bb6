"""A recorder that is emptied while the node runs, to limit memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from pytest_tarl.instrumentation.events import paired, sizes
from pytest_tarl.instrumentation.recorder import Recorder
from pytest_tarl.instrumentation.trace import Floats, Ints
from pytest_tarl.sensors import Cell

# maximum number of queued entries (two per event); further events are dropped and counted
MOST_ENTRIES = 4_000_000


@dataclass(frozen=True)
class Chunk:
    """The events between two cuts, as columns.

    Columns of events have shape (events,), columns of steps (steps,). `step` counts from the chunk's first step. Events
    after the chunk's last reward belong to a step that a later chunk closes.
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
        """Return whether there is nothing to write."""
        return not self.site.size and not self.reward.size


class Cut(NamedTuple):
    """The events since the last cut, as plain values."""

    cells: list[Cell]  # cells new in this cut
    latched: list[int]  # for each mark in the buffer, the index of the current cell
    rewards: list[int]  # indices of the marks at which a step ends
    totals: list[float]
    threads: list[
        tuple[list[Any], list[int]]
    ]  # for each thread: its entries, and the number of entries at each mark

    @property
    def empty(self) -> bool:
        """Return whether there is nothing to write."""
        return not self.rewards and not any(entries for entries, _ in self.threads)


class Stream(Recorder):
    """An endless recorder; `cut` removes and returns the events recorded so far."""

    _packing = False  # any thread may call `reward`, which therefore must not pack a buffer

    def __init__(self) -> None:
        super().__init__(threads=True)
        self.dropped = 0
        self._told = 0  # number of cells in earlier cuts

    def reward(self, total: float, parts: Mapping[str, float] | None = None) -> None:  # noqa: ARG002 - as the base
        """Close a step with its reward; logs store no parts of rewards."""
        with self._lock:
            latched = self._latched
            self._rewards.append(len(latched))
            self._mark(latched[-1] if latched else -1)
            self._totals.append(float(total))

    def cut(self, drop: bool = False) -> Cut:
        """Take the events since the last call, from any thread.

        It only slices lists, to be fast. With `drop` (when memory is short), events are only counted; rewards and cells
        are kept.
        """
        if drop:
            self.relieve(0)
        with self._lock:
            latched, rewards, totals = self._latched, self._rewards, self._totals
            self._latched, self._rewards, self._totals = latched[-1:], [], []
            threads = []
            for buffer in self._buffers:
                entries = _cut(buffer.entries)
                threads.append((entries, [min(length, len(entries)) for length in buffer.lengths]))
                buffer.lengths = [0] * len(self._latched)
            cells = [*islice(self._cells, self._told, None)]
            self._told += len(cells)
        return Cut(cells, latched, rewards, totals, threads)

    def relieve(self, most: int | None = None) -> None:
        """Drop the events of threads with more than `most` entries, and count them.

        `most` is MOST_ENTRIES by default.
        """
        most = MOST_ENTRIES if most is None else most
        for buffer in tuple(self._buffers):
            if len(buffer.entries) > most:
                with self._lock:
                    lost = _cut(buffer.entries)
                    buffer.lengths = [0] * len(buffer.lengths)
                self.dropped += len(lost) // 2


def chunk(cut: Cut, known: list[Cell]) -> Chunk:
    """Convert a cut to columns; append its new cells to `known`."""
    known += map(tuple, cut.cells)
    columns = [_columns(entries, lengths, cut.latched, cut.rewards) for entries, lengths in cut.threads]
    threads = [np.full(len(column[0]), number, np.int32) for number, column in enumerate(columns)]
    site, flow, cell, step = (np.concatenate(part) for part in zip(*columns, strict=True))
    thread = np.concatenate(threads)
    step_cell = np.array(cut.latched, np.int32)[cut.rewards]
    rewards = np.array(cut.totals, np.float64)
    return _in_order(Chunk(tuple(known), site, flow, cell, step, thread, step_cell, rewards))


def merged(cuts: Sequence[Cut]) -> Cut:
    """Merge one or more consecutive cuts."""
    if len(cuts) == 1:
        return cuts[0]
    cells, latched, rewards, totals = list[Cell](), list[int](), list[int](), list[float]()
    threads: list[tuple[list[Any], list[int]]] = []
    for cut in cuts:
        carried = 1 if latched else 0  # a cut repeats the last cell of the previous one
        rewards += [mark + len(latched) - carried for mark in cut.rewards]
        threads += [([], [0] * len(latched)) for _ in cut.threads[len(threads) :]]
        for (entries, lengths), (new, marks) in zip(threads, cut.threads, strict=True):
            lengths += [len(entries) + mark for mark in marks[carried:]]
            entries += new
        cells += cut.cells
        latched += cut.latched[carried:]
        totals += cut.totals
    return Cut(cells, latched, rewards, totals, threads)


def _in_order(one: Chunk) -> Chunk:
    """Return a chunk sorted by step, then by thread."""
    order = np.lexsort((one.thread, one.step))
    events = {name: getattr(one, name)[order] for name in ("site", "flow", "cell", "step", "thread")}
    return replace(one, **events)


def _cut(entries: list[Any]) -> list[Any]:
    """Remove complete events from the front while the owning thread may be appending."""
    count = len(entries)
    if count and type(entries[count - 1]) is int:
        count -= 1  # the last entry is a site; its thread has not appended the value yet
    taken = entries[:count]
    del entries[:count]
    return taken


def _columns(
    entries: list[Any], lengths: list[int], latched: list[int], rewards: list[int]
) -> tuple[Ints, Floats, Ints, Ints]:
    """Return site, flow, cell and step of each event of a thread, each of shape (events,)."""
    site, flow, starts = paired(entries)
    before = np.searchsorted(starts, np.array(lengths, np.int64), side="left")
    between = np.diff(before, prepend=0, append=len(starts))
    cells = np.array([-1, *latched], np.int32)
    closing = np.zeros(len(cells), np.int32)
    closing[np.array(rewards, np.int64) + 1] = 1
    steps = np.cumsum(closing).astype(np.int32)
    return site, sizes(flow), np.repeat(cells, between), np.repeat(steps, between)
