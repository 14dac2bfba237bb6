"""Schedule tasks, which are greenlets, on a virtual clock.

All tasks are resumed from one place: the greenlet that called into the episode. A task never resumes another task
directly; it only requests this (`wake`, `later`) and continues until it waits itself. The order of execution is
therefore deterministic.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable
from functools import partial
from heapq import heappop, heappush
from typing import Any, Protocol

try:  # the C part of asyncio, which is faster to import than asyncio
    from _asyncio import _get_running_loop, _set_running_loop
except ImportError:
    from asyncio import _get_running_loop, _set_running_loop
from greenlet import GreenletExit, getcurrent, greenlet

from pytest_tarl.errors import NodeError, StuckNodeError
from pytest_tarl.ros import blame
from pytest_tarl.ros.watchdog import WATCHDOG, Spinning

NO_HOOKS: tuple[Any, ...] = (None, None)
PATIENCE = 500  # a task that polls this often without time passing counts as polling (see polling.py)


class Program(Protocol):
    """What the scheduler needs from a task's process (see `Process`)."""

    label: str
    tasks: list[Task]
    ending: bool

    @property
    def scheduler(self) -> Scheduler:
        """Return the scheduler that runs its tasks."""

    def failed(self, task: Task, error: BaseException) -> None:
        """Handle the exception that ended a task."""

    def finished(self, task: Task) -> None:
        """Remove a task that has ended."""

    def spins(self, place: blame.Place | None) -> NodeError:
        """Return the error for a task that never waits."""

    def refuse_to_wait(self) -> None:
        """Count a wait that returns at once because the process is ending."""


class Task:
    """A thread of control of a process: its main program, a running callback, or a timer."""

    __slots__ = (
        "args",
        "asyncgen_hooks",
        "done",
        "function",
        "loop",
        "parked",
        "patience",
        "process",
        "ticket",
        "worker",
    )

    def __init__(self, process: Program, function: Callable[..., Any], args: tuple[Any, ...]) -> None:
        self.process = process
        self.function = function
        self.args = args
        self.ticket = 0  # increases with every resumption; heap entries with a lower number are stale
        self.parked = False
        self.patience = PATIENCE  # number of polls until the task must wait
        self.done = False
        self.loop: Any = None  # asyncio's running loop while the task waits inside it
        # asyncio's hooks for asynchronous generators while its loop runs; there is one pair per thread
        self.asyncgen_hooks: tuple[Any, ...] = NO_HOOKS
        self.worker: Worker | None = None

    def execute(self) -> None:
        """Run the task's function; pass an exception to its process."""
        try:
            self.function(*self.args)
        except GreenletExit:
            pass
        except BaseException as error:
            self.process.failed(self, error)
        finally:
            self.done = True
            self.process.finished(self)


class Worker(greenlet):
    """A greenlet that runs tasks one after another: creating one costs ten times as much as a switch."""

    def __init__(self, idle: list[Worker]) -> None:
        super().__init__()
        self.task: Task | None = None
        self._idle = idle

    def run(self, *_: Any) -> None:
        """Run the assigned task, then wait for the next, forever."""
        while self.task is not None:
            self.task.execute()
            self.task = None
            self._idle.append(self)
            hand_over()


def hand_over() -> Any:
    """Switch to the greenlet that resumed this one; return the value passed at the next resumption.

    Raise RuntimeError outside tasks.
    """
    parent = getcurrent().parent
    if parent is None:
        raise RuntimeError("only a task can hand over")
    return parent.switch()


def running_task() -> Task | None:
    """Return the running task, or None outside tasks."""
    worker = getcurrent()
    return worker.task if isinstance(worker, Worker) else None


def current_task() -> Task:
    """Return the running task. Raise RuntimeError outside tasks."""
    task = running_task()
    if task is None:
        raise RuntimeError("only a task has a current task")
    return task


class Scheduler:
    """The virtual clock (`time`, ns), tasks that wait for a time, and tasks that are ready."""

    def __init__(self) -> None:
        self.time = 0
        self.failure: BaseException | None = None
        # whether a task has run an event loop; asyncio has one running loop per thread
        self.keeps_loops = False
        self._sleeping: list[tuple[int, int, Task, int]] = []
        self._alarms: list[tuple[int, int, Callable[[], None]]] = []
        self._ready: deque[Callable[[], None]] = deque()
        self._sequence = 0
        self._running: Task | None = None
        self._idle: list[Worker] = []
        self.entering: Callable[[Program], None] | None = None  # called before a task of a program is resumed

    def wait(self, until: int | None = None) -> bool:
        """Suspend the running task until the time `until`, or until it is woken; return whether it was woken.

        Raise RuntimeError outside tasks.
        """
        worker = getcurrent()
        task = worker.task if isinstance(worker, Worker) else None
        if task is None or worker.parent is None:
            raise RuntimeError("only a task can wait")
        task.parked = True
        if until is None or until > self.time:
            task.patience = PATIENCE
        if until is not None:
            self._sequence += 1
            heappush(self._sleeping, (until, self._sequence, task, task.ticket))
        return bool(worker.parent.switch())

    def yield_now(self) -> None:
        """Let all ready tasks run, then continue, without time passing."""
        task = current_task()
        task.parked = True
        self.wake(task)
        hand_over()

    def wake(self, task: Task) -> None:
        """Make a waiting task ready; it resumes when the running task waits."""
        if task.parked:
            task.parked = False
            task.ticket += 1
            self._ready.append(partial(self._resume, task, True))

    def spawn(self, process: Program, function: Callable[..., Any], *args: Any) -> Task:
        """Start a task: at once if called outside tasks, otherwise when the running task waits."""
        task = Task(process, function, args)
        process.tasks.append(task)
        if running_task() is not None:
            self._ready.append(partial(self._resume, task, True))
        else:
            self._resume(task, True)
        return task

    def later(self, job: Callable[[], None]) -> None:
        """Call a function outside tasks, when the running task waits."""
        self._ready.append(job)

    def at(self, instant: int, job: Callable[[], None]) -> None:
        """Call a function outside tasks at a virtual time (ns), before the tasks that wake at that time."""
        self._sequence += 1
        heappush(self._alarms, (instant, self._sequence, job))

    def settle(self) -> None:
        """Run until no task is ready at the current time."""
        ready = self._ready
        while ready and self.failure is None:
            ready.popleft()()

    def advance(self, until: int) -> None:
        """Advance the clock to `until` (ns); run the tasks and alarms that become due, in order of time."""
        alarms = self._alarms
        self._run_tasks(until)
        while alarms and alarms[0][0] <= until and self.failure is None:
            instant, _, job = heappop(alarms)
            self.time = max(self.time, instant)
            job()
            self._run_tasks(until)
        if self.failure is None:
            self.time = max(self.time, until)

    def _run_tasks(self, until: int) -> None:
        """Run the tasks due by `until` and before the next alarm; they may set an earlier alarm."""
        if self._ready:
            self.settle()
        sleeping, alarms = self._sleeping, self._alarms
        while sleeping and sleeping[0][0] <= until and self.failure is None:
            if alarms and alarms[0][0] <= sleeping[0][0]:
                return
            time, _, task, ticket = heappop(sleeping)
            if ticket != task.ticket or task.done:
                continue
            if time > self.time:
                self.time = time
                WATCHDOG.beat()
            task.parked = False
            self._resume(task, False)
            if self._ready:
                self.settle()

    def kill(self, task: Task) -> None:
        """Kill a task where it waits."""
        task.ticket += 1
        if task.worker is None:
            task.done = True
            # never started, so there is no stack to unwind
            task.process.finished(task)
        elif not task.done:
            task.worker.parent = getcurrent()
            task.worker.throw(GreenletExit)

    def close(self) -> None:
        """End the greenlets, which are idle by now."""
        for worker in self._idle:
            worker.parent = getcurrent()
            worker.throw(GreenletExit)
        self._idle.clear()

    def spinning(self) -> NodeError:
        """Return the error for the task that ran last and never waits."""
        task = self._running
        if task is None or task.worker is None:
            return StuckNodeError("A node never waits.")
        return task.process.spins(blame.of_frame(task.worker.gr_frame))

    def interrupt(self, task: Task, error: BaseException) -> None:
        """Raise an exception where a task waits. Call this outside tasks."""
        if task.parked:
            task.parked = False
            task.ticket += 1
            self._resume(task, True, error)
        elif not task.done:  # ready: it will wait again after it has run
            self.later(partial(self.interrupt, task, error))

    def _resume(self, task: Task, woken: bool, error: BaseException | None = None) -> None:
        if task.done:
            return
        worker = task.worker
        if worker is None:
            worker = task.worker = self._idle.pop() if self._idle else Worker(self._idle)
            worker.task = task
        task.ticket += 1
        worker.parent = getcurrent()
        self._running = task
        if self.entering is not None:
            self.entering(task.process)
        outer, outer_hooks = None, NO_HOOKS
        if self.keeps_loops:
            outer, outer_hooks = _get_running_loop(), sys.get_asyncgen_hooks()
            _set_running_loop(task.loop)
            sys.set_asyncgen_hooks(*task.asyncgen_hooks)
        if error is None:
            worker.switch(woken)
        else:
            worker.throw(error)
        if self.keeps_loops:
            task.loop, task.asyncgen_hooks = _get_running_loop(), tuple(sys.get_asyncgen_hooks())
            _set_running_loop(outer)
            sys.set_asyncgen_hooks(*outer_hooks)


__all__ = ["Program", "Scheduler", "Spinning", "Task", "current_task", "running_task"]
