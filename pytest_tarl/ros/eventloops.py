"""Run nodes' event loops (such as asyncio's) on the virtual clock: their selectors wait in virtual time."""

from __future__ import annotations

import selectors
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.keyboard import NodeInterruptedError
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.scheduler import Scheduler, running_task

_POLL = nanoseconds(0.01)  # polling period of files and sockets (ns)
_KINDS: Final[tuple[type[Any], ...]] = tuple(
    getattr(selectors, name)
    for name in ("EpollSelector", "PollSelector", "KqueueSelector", "DevpollSelector", "SelectSelector")
    if hasattr(selectors, name)
)


@contextmanager
def virtual_event_loops(scheduler: Scheduler) -> Iterator[None]:
    """Make selectors of nodes wait in virtual time; other code waits in real time."""
    saved = [(kind, kind.select) for kind in _KINDS]
    for kind, real in saved:
        kind.select = _select(real, scheduler)
    try:
        yield
    finally:
        for kind, real in saved:
            kind.select = real


def _select(real: Callable[..., Any], scheduler: Scheduler) -> Callable[..., Any]:
    interrupted: set[int] = set()  # ids of selectors whose event loops know that the episode ends

    def select(selector: Any, timeout: float | None = None) -> Any:
        task = running_task()
        if task is None:
            return real(selector, timeout)
        scheduler.keeps_loops = True
        until = None if timeout is None else scheduler.time + max(nanoseconds(timeout), 0)
        while True:
            ready = real(selector, 0)
            if ready or (until is not None and scheduler.time >= until):
                asked()
                return ready
            if task.process.ending:
                if id(selector) not in interrupted:
                    interrupted.add(id(selector))
                    raise NodeInterruptedError
                task.process.refuse_to_wait()
                return ready
            next_look = scheduler.time + _POLL
            scheduler.wait(next_look if until is None else min(until, next_look))

    return select
