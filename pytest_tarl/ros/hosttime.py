"""Let nodes see the virtual clock through Python's `time` module too; everybody else keeps the real one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.scheduler import Scheduler, running_task

_IN_SECONDS = ("time", "monotonic", "perf_counter")
_IN_NANOSECONDS = ("time_ns", "monotonic_ns", "perf_counter_ns")


@contextmanager
def virtual_host_time(scheduler: Scheduler) -> Iterator[None]:
    """Replace `time.sleep` and the clocks of the `time` module while nodes run."""
    saved = {name: getattr(time, name) for name in (*_IN_SECONDS, *_IN_NANOSECONDS, "sleep")}
    for name in _IN_SECONDS:
        setattr(time, name, _clock(saved[name], lambda: seconds(scheduler.time)))
    for name in _IN_NANOSECONDS:
        setattr(time, name, _clock(saved[name], lambda: scheduler.time))
    setattr(time, "sleep", _sleep(saved["sleep"], scheduler))  # noqa: B010 (mypy knows time.sleep as final)
    try:
        yield
    finally:
        for name, function in saved.items():
            setattr(time, name, function)


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
