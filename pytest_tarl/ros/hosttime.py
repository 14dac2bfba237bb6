"""Show the virtual clock in Python's `time` module to nodes; other code keeps the real one."""

from __future__ import annotations

import queue
import select
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from pytest_tarl.ros import keyboard
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.scheduler import Scheduler, running_task

REAL_MONOTONIC = time.monotonic

_CLOCKS: tuple[tuple[Any, str], ...] = (
    (time, "time"),
    (time, "monotonic"),
    (time, "perf_counter"),
    (time, "time_ns"),
    (time, "monotonic_ns"),
    (time, "perf_counter_ns"),
    (time, "sleep"),
    (select, "select"),
    (threading, "_time"),  # threading and queue know time.monotonic by these names
    (queue, "time"),
)

_POLL = nanoseconds(0.01)  # polling period of `select` (ns)


@contextmanager
def virtual_host_time(scheduler: Scheduler) -> Iterator[None]:
    """Replace `time.sleep` and the clocks of `time` while nodes run."""
    saved = [(owner, name, getattr(owner, name)) for owner, name in _CLOCKS]
    for owner, name, real in saved:
        virtual = (lambda: scheduler.time) if name.endswith("_ns") else (lambda: seconds(scheduler.time))
        waiting = {"sleep": _sleep, "select": _select}.get(name)
        if waiting is not None:
            setattr(owner, name, waiting(real, scheduler))
        else:
            setattr(owner, name, _clock(real, virtual, question=owner is time))
    try:
        yield
    finally:
        for owner, name, real in saved:
            setattr(owner, name, real)


def _clock(real: Callable[[], Any], virtual: Callable[[], Any], *, question: bool) -> Callable[[], Any]:
    """Return a clock for nodes. Reading it counts as polling, unless the standard library reads it in order to wait."""

    def read() -> Any:
        if running_task() is None:
            return real()
        if question:
            asked()
        return virtual()

    return read


def _select(real: Callable[..., Any], scheduler: Scheduler) -> Callable[..., Any]:
    """Poll a keyboard or socket in virtual time; return at once if data is ready."""

    def select(rlist: Any, wlist: Any, xlist: Any, timeout: float | None = None) -> Any:
        task = running_task()
        if task is None:
            return real(rlist, wlist, xlist, timeout)
        until = None if timeout is None else scheduler.time + nanoseconds(timeout)
        if until is not None and scheduler.time >= until:
            asked()
        typed, others, terminal = keyboard.split(rlist)
        while True:
            ready = real(others, wlist, xlist, 0) if others or wlist or xlist else ([], [], [])
            if terminal is not None and terminal.look():
                ready = ([*typed, *ready[0]], *ready[1:])
            if any(ready) or (until is not None and scheduler.time >= until):
                return ready
            if task.process.ending:
                task.process.refuse_to_wait()
                return ready
            next_look = scheduler.time + _POLL
            scheduler.wait(next_look if until is None else min(until, next_look))

    return select


def _sleep(real: Callable[[float], None], scheduler: Scheduler) -> Callable[[float], None]:
    def sleep(duration: float) -> None:
        task = running_task()
        if task is None:
            real(duration)
            return
        if duration < 0:
            raise ValueError("sleep length must be non-negative")
        if duration == 0:
            asked()
        until = scheduler.time + nanoseconds(duration)
        while scheduler.time < until and not task.process.ending:
            scheduler.wait(until)
        if task.process.ending:
            task.process.refuse_to_wait()

    return sleep
