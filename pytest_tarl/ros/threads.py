"""Run a node's threads as tasks, and let its locks suspend tasks, so that execution is deterministic."""

from __future__ import annotations

import queue
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from pytest_tarl.ros import blame
from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.scheduler import Scheduler, Task, running_task

_OWN = str(Path(__file__).parents[1])  # threads started by this package stay real
_STDLIB = str(Path(threading.__file__).parent)
_PASSED_THROUGH = (
    threading.__file__,
    queue.__file__,
    f"{_STDLIB}/concurrent/futures/",
    f"{_STDLIB}/asyncio/",
    __file__,
)  # modules that create locks, queues and threads for their callers


@contextmanager
def threads_as_tasks() -> Iterator[None]:
    """Replace the threads and locks of `threading` while nodes run; other code gets the real ones."""
    replaced = [
        (threading, "Lock", _instead(threading.Lock, Lock)),
        (threading, "RLock", _instead(threading.RLock, ReentrantLock)),
        (threading, "_allocate_lock", _instead(threading.Lock, Lock)),  # called by Condition.wait
        (queue, "SimpleQueue", _simple_queue(queue.SimpleQueue)),  # used by concurrent.futures
        (threading.Thread, "start", _start(threading.Thread.start)),
        (threading.Thread, "join", _join(threading.Thread.join)),
        (threading.Thread, "is_alive", _is_alive(threading.Thread.is_alive)),
    ]
    saved = [(owner, name, getattr(owner, name)) for owner, name, _ in replaced]
    for owner, name, value in replaced:
        setattr(owner, name, value)
    try:
        yield
    finally:
        for owner, name, value in saved:
            setattr(owner, name, value)
        _forget_pools()


def _forget_pools() -> None:
    """Remove threads that run as tasks from those that concurrent.futures joins when Python exits."""
    pools: Any = sys.modules.get("concurrent.futures.thread")
    if pools is None:
        return
    for thread in [one for one in pools._threads_queues if "_tarl_task" in vars(one)]:
        del pools._threads_queues[thread]


class Lock:
    """A lock that suspends only the waiting task."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._held = False
        self._waiting: deque[Task] = deque()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock; return whether this succeeded. Raise RuntimeError if the test itself would deadlock."""
        clock = self._scheduler
        until = clock.time + nanoseconds(timeout) if timeout >= 0 else None
        while self._held:
            task = running_task()
            if not blocking or (until is not None and clock.time >= until):
                return False
            if task is None:
                raise RuntimeError(
                    "The test waits for a lock held by a node that is itself waiting, so neither can "
                    "continue: call tarl.step first."
                )
            self._waiting.append(task)
            try:
                clock.wait(until)
            finally:  # after a timeout or an exception, `release` must not wake this task instead of a waiting one
                if task in self._waiting:
                    self._waiting.remove(task)
        self._held = True
        return True

    def release(self) -> None:
        """Release the lock; wake the longest-waiting task. Raise RuntimeError if the lock is not held."""
        if not self._held:
            raise RuntimeError("release unlocked lock")
        self._held = False
        if self._waiting:
            self._scheduler.wake(self._waiting.popleft())

    def locked(self) -> bool:
        """Return whether the lock is held."""
        return self._held

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()


class ReentrantLock(Lock):
    """A lock that its holder can acquire again."""

    def __init__(self, scheduler: Scheduler) -> None:
        super().__init__(scheduler)
        self._owner: Task | None = None  # last holder, meaningful only while the lock is held
        self._count = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock, even if the running task already holds it."""
        if not (self._held and self._owner is running_task()):
            if not super().acquire(blocking, timeout):
                return False
            self._owner = running_task()
        self._count += 1
        return True

    def release(self) -> None:
        """Release the lock once; it is free after as many releases as acquisitions.

        Raise RuntimeError unless the running task holds it.
        """
        if not self._is_owned():
            raise RuntimeError("cannot release un-acquired lock")
        self._count -= 1
        if self._count == 0:
            super().release()

    def _is_owned(self) -> bool:  # part of threading.Condition's interface
        return self._held and self._owner is running_task()

    def _release_save(self) -> int:
        count, self._count = self._count, 1
        self.release()
        return count

    def _acquire_restore(self, count: int) -> None:
        self.acquire()
        self._count = count


def _instead(real: Callable[[], Any], own: Callable[[Scheduler], Lock]) -> Callable[[], Any]:
    def make() -> Any:
        task = running_task()
        return own(task.process.scheduler) if task is not None and _asked_by_node() else real()

    return make


def _simple_queue(real: Callable[[], Any]) -> Callable[[], Any]:
    """Return a function that gives nodes Python's own implementation of queues, whose locks suspend tasks."""

    def make() -> Any:
        return queue._PySimpleQueue() if running_task() is not None and _asked_by_node() else real()  # type: ignore[attr-defined]

    return make


def _asked_by_node() -> bool:
    """Return whether the caller is a node's own code, or starts one of its threads.

    Locks that a library creates while it is imported outlive the episode.
    """
    frame: FrameType | None = sys._getframe(2)
    while frame is not None and frame.f_code.co_filename.startswith(_PASSED_THROUGH):
        if frame.f_code is _run_as_task.__code__:
            return True
        frame = frame.f_back
    file = "<" if frame is None else frame.f_code.co_filename
    return not (file.startswith(_OWN) or blame.is_library(file))


def _start(real: Callable[[threading.Thread], None]) -> Callable[[threading.Thread], None]:
    def start(thread: threading.Thread) -> None:
        task = running_task()
        if task is None or not _asked_by_node():
            real(thread)
            return
        if "_tarl_task" in vars(thread):
            raise RuntimeError("threads can only be started once")
        joiners: list[Task] = []
        vars(thread)["_tarl_joiners"] = joiners
        scheduler = task.process.scheduler

        vars(thread)["_tarl_task"] = scheduler.spawn(task.process, _run_as_task, thread, joiners, scheduler)

    return start


def _run_as_task(thread: threading.Thread, joiners: list[Task], scheduler: Scheduler) -> None:
    try:
        thread.run()
    finally:
        for joiner in joiners:
            scheduler.wake(joiner)


def _join(real: Callable[..., None]) -> Callable[..., None]:
    def join(thread: threading.Thread, timeout: float | None = None) -> None:
        joined: Task | None = vars(thread).get("_tarl_task")
        task = running_task()
        if joined is None or task is None:
            real(thread, timeout) if joined is None else None
            return
        scheduler = task.process.scheduler
        until = None if timeout is None else scheduler.time + nanoseconds(timeout)
        vars(thread)["_tarl_joiners"].append(task)
        while not joined.done and (until is None or scheduler.time < until):
            scheduler.wait(until)

    return join


def _is_alive(real: Callable[[threading.Thread], bool]) -> Callable[[threading.Thread], bool]:
    def is_alive(thread: threading.Thread) -> bool:
        task: Task | None = vars(thread).get("_tarl_task")
        if task is None:
            return real(thread)
        asked()
        return not task.done

    return is_alive
