"""Let nodes see the virtual clock through Python's `time` module too; everybody else keeps the real one."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from pytest_tarl.ros.clock import nanoseconds, seconds
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
    (threading, "_time"),  # these two have bound time.monotonic under their own names
    (queue, "time"),
)


@contextmanager
def virtual_host_time(scheduler: Scheduler) -> Iterator[None]:
    """Replace `time.sleep` and the clocks of the `time` module while nodes run."""
    saved = [(owner, name, getattr(owner, name)) for owner, name in _CLOCKS]
    for owner, name, real in saved:
        virtual = (lambda: scheduler.time) if name.endswith("_ns") else (lambda: seconds(scheduler.time))
        setattr(owner, name, _sleep(real, scheduler) if name == "sleep" else _clock(real, virtual))
    try:
        yield
    finally:
        for owner, name, real in saved:
            setattr(owner, name, real)


def _clock(real: Callable[[], Any], virtual: Callable[[], Any]) -> Callable[[], Any]:
    def read() -> Any:
        return virtual() if running_task() is not None else real()

    return read


def _sleep(real: Callable[[float], None], scheduler: Scheduler) -> Callable[[float], None]:
    def sleep(duration: float) -> None:
        task = running_task()
        if task is None:
            real(duration)
            return
        if duration < 0:
            raise ValueError("sleep length must be non-negative")
        until = scheduler.time + nanoseconds(duration)
        while scheduler.time < until and not task.process.ending:
            scheduler.wait(until)
        if task.process.ending:
            task.process.refuse_to_wait()

    return sleep
