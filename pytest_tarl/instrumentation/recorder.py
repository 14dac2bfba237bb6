"""Record the events of an episode. Most of the work is done at the end, to slow the node down as little as possible.

A buffer is a flat list per thread, `[site, value, site, value, …]`. Events of the simulation (a new current cell, or
the reward of a step) are marks in a separate list, stored with the length of every buffer at that moment. The separate
list ensures that each buffer has a single writer. Greenlets of a thread share its buffer.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import CodeType
from typing import Any, TypeVar

import numpy as np

from pytest_tarl.instrumentation.constants import bound
from pytest_tarl.instrumentation.entries import Entries, SharedEntries
from pytest_tarl.instrumentation.events import Pairs, joined, limited, paired, sizes
from pytest_tarl.instrumentation.magnitude import magnitude
from pytest_tarl.instrumentation.thread_starts import ThreadWatch
from pytest_tarl.instrumentation.trace import Floats, Ints, Trace
from pytest_tarl.sensors import Cell

EXACT = 2**53  # smaller integers convert to float exactly, as the fast path requires
MANY = 200_000  # a buffer with more entries is packed into columns after a step
_TOOLS = frozenset(
    {"pytest_tarl", "_pytest", "execnet", "pytest_rerunfailures", "pytest_timeout", "slipcover", "xdist"}
)
T = TypeVar("T")
Hook = Callable[[int, Any], Any]


@dataclass
class _Buffer:
    """The events of one thread; `lengths[i]` is the number of its entries at mark i, including packed ones."""

    entries: list[Any] = field(default_factory=list)
    lengths: list[int] = field(default_factory=list)
    packed: list[Pairs] = field(default_factory=list)
    gone: int = 0  # number of entries already packed into columns

    def pack(self) -> None:
        """Convert the entries to columns. Call this in the buffer's own thread, or after the episode."""
        entries = self.entries[:]  # this copy is atomic; another thread may still be appending
        self.entries.clear()
        site, flow, starts = paired(entries)
        self.packed.append((site, flow, starts + self.gone if self.gone else starts))
        self.gone += len(entries)


class Recorder:
    """Record one episode.

    Any thread may call `hook`. `bind` gives instrumented code a faster hook, and the buffer of the thread that created
    the recorder. When a second thread starts, each thread gets its own entries. They are separate from the start if
    `threads` is true (as a real ROS requires), or if another thread already exists that may run the program.
    """

    _packing = True  # whether `reward` may pack the buffer of the creating thread

    def __init__(self, *, threads: bool = False) -> None:
        self._lock = threading.Lock()
        self._local = threading.local()
        self._buffers: list[_Buffer] = []
        self._cells: dict[Cell, int] = {}
        # for each mark in the buffer, the index of the current cell from there on
        self._latched: list[int] = []
        self._rewards: list[int] = []  # indices of the marks at which a step ends
        self._totals: list[float] = []
        self._parts: list[Mapping[str, float]] = []
        self.hook: Callable[[int, T], T] = _threaded_hook(self._entries)
        self._maker, self._own = threading.get_ident(), _Buffer(Entries(self._entries))
        self._buffers.append(self._own)
        self._local.entries = self._own.entries
        self._single = not threads and _alone()
        self._bound_hook = _plain_hook(self._own.entries) if self._single else self.hook
        if not self._single:
            self._share()
        self._watch, self._watching = ThreadWatch(self._share), False

    def __reduce__(self) -> tuple[type[_Elsewhere], tuple[()]]:
        """Pickle as `_Elsewhere`: pickled functions may refer to a recorder, but other processes record nothing."""
        return _Elsewhere, ()

    def bind(self, code: CodeType) -> CodeType:
        """Return instrumented code that records into this recorder."""
        if self._single and not self._watching:
            self._watching = True
            self._watch.begin()
        return bound(code, self._bound_hook, self._own.entries)

    def latch(self, cell: Cell | None) -> None:
        """Set the current cell; None if it is unknown."""
        with self._lock:
            self._mark(-1 if cell is None else self._cells.setdefault(cell, len(self._cells)))

    def reward(self, total: float, parts: Mapping[str, float] | None = None) -> None:
        """Close a simulation step with its reward."""
        with self._lock:
            self._rewards.append(len(self._latched))
            self._mark(self._latched[-1] if self._latched else -1)
            self._totals.append(float(total))
            self._parts.append(dict(parts or {}))
        if self._packing and len(self._own.entries) > MANY and threading.get_ident() == self._maker:
            self._own.pack()

    def finish(self, *, signed: bool = False) -> Trace:
        """End the episode and return its trace; with `signed`, numbers keep their signs. Drop later events."""
        self._watch.end()
        parts = [self._columns(buffer, number) for number, buffer in enumerate(self._buffers)]
        columns = [np.concatenate(part) for part in zip(*parts, strict=True)]
        if len(self._buffers) > 1:
            order = np.lexsort((columns[4], columns[3]))
            columns = [column[order] for column in columns]
        site, values, event_cell, event_step, thread = columns
        latched = np.array(self._latched, np.int32)
        return Trace(
            cells=tuple(self._cells),
            site=site,
            flow=limited(values) if signed else sizes(values),
            event_cell=event_cell,
            event_step=event_step,
            step_cell=latched[self._rewards],
            reward=np.array(self._totals, np.float64),
            parts=self._part_columns(),
            thread=thread if len(self._buffers) > 1 else None,
        )

    def _mark(self, cell: int) -> None:
        self._latched.append(cell)
        for buffer in self._buffers:
            buffer.lengths.append(buffer.gone + len(buffer.entries))

    def _entries(self) -> list[Any]:
        """Return the entries of the running thread."""
        try:
            entries: list[Any] = self._local.entries
        except AttributeError:
            with self._lock:
                buffer = _Buffer(lengths=[0] * len(self._latched))
                self._buffers.append(buffer)
            entries = self._local.entries = buffer.entries
        return entries

    def _share(self) -> None:
        """Keep the threads' entries separate from now on."""
        self._single = False
        self._own.entries.__class__ = SharedEntries

    def _columns(self, buffer: _Buffer, number: int) -> tuple[Ints, Floats, Ints, Ints, Ints]:
        """Return a thread's events as five columns: site, value, cell, step, thread; each of shape (events,)."""
        buffer.pack()
        site, flow, starts = joined(buffer.packed)
        before = np.searchsorted(starts, np.array(buffer.lengths, np.int64), side="left")
        bounds = np.concatenate(([0], before, [len(starts)]))
        between = bounds[1:] - bounds[:-1]  # number of events before each mark, and after the last
        cells = np.array([-1, *self._latched], np.int32)
        closing = np.zeros(len(cells), np.int32)
        closing[np.array(self._rewards, np.int64) + 1] = 1
        steps = np.minimum(np.cumsum(closing), max(0, len(self._rewards) - 1)).astype(np.int32)
        thread = np.full(len(site), number, np.int32)
        return site, flow, np.repeat(cells, between), np.repeat(steps, between), thread

    def _part_columns(self) -> dict[str, Floats]:
        names = dict.fromkeys(name for parts in self._parts for name in parts)
        return {name: np.array([parts.get(name, 0.0) for parts in self._parts], np.float64) for name in names}


def _alone() -> bool:
    """Return whether all other threads belong to test tools, which never run the program's code."""
    return all(
        _of_tool(thread) for thread in threading.enumerate() if thread is not threading.current_thread()
    )


def _of_tool(thread: threading.Thread) -> bool:
    # threading.Timer stores its function as `function`
    runs = getattr(thread, "_target", None) or getattr(thread, "function", None)
    return str(getattr(runs, "__module__", None)).partition(".")[0] in _TOOLS


class _Elsewhere:
    """Takes the place of a recorder in a process that does not record. `Recorder._entries` accepts it as `self`."""

    __slots__ = ()

    @property
    def _local(self) -> _Elsewhere:
        return self

    @property
    def entries(self) -> list[Any]:
        """Return a list that nobody reads."""
        return []


def _plain_hook(entries: list[Any]) -> Hook:
    """Return the hook for a program that starts with one thread; `entries` separates later threads."""
    size = magnitude

    def hook(number: int, value: Any) -> Any:
        kind = type(value)
        if kind is float:
            entries.append(number)
            entries.append(value)
        elif kind is int and -EXACT < value < EXACT:
            entries.append(number)
            entries.append(value + 0.0)
        elif kind is bool:
            entries.append(number)
            entries.append(1.0 if value else 0.0)
        else:
            flow = size(value)
            entries.append(number)
            entries.append(flow)
        return value

    return hook


def _threaded_hook(own: Callable[[], list[Any]]) -> Hook:
    """Return the hook for programs with several threads."""
    size, extend = magnitude, list.extend

    def hook(number: int, value: Any) -> Any:
        flow = value if type(value) is float else size(value)
        extend(own(), (number, flow))
        return value

    return hook
