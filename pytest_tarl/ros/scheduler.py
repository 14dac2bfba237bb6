"""Who runs, who waits and until when: tasks as greenlets on a virtual clock.

All tasks are resumed from one place, the greenlet that called into the episode. A task never resumes another
one: it asks for it (`wake`, `later`) and goes on until it waits itself. So a run is one fixed sequence.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any

from greenlet import GreenletExit, getcurrent, greenlet

from pytest_tarl.errors import NodeError
from pytest_tarl.ros import blame
from pytest_tarl.ros.watchdog import WATCHDOG, Spinning

if TYPE_CHECKING:
    from pytest_tarl.ros.process import Process


class Task(greenlet):
    """One thread of control of a process: its main program, a callback that is running, a timer."""

    def __init__(self, process: Process, function: Callable[..., Any], *, main: bool = False) -> None:
        super().__init__()
        self.process = process
        self.function = function
        self.main = main
        self.ticket = 0  # grows at every resumption; a heap entry with an older one is void
        self.parked = False

    def run(self, *args: Any) -> None:
        """Run the task's function; whatever it ends in is handed to its process."""
        try:
            self.function(*args)
        except GreenletExit:
            pass
        except BaseException as error:
            self.process.failed(self, error)
        finally:
            self.process.finished(self)


def current_task() -> Task:
    """Return the running task. Called within one."""
    task = getcurrent()
    assert isinstance(task, Task)
    return task


class Scheduler:
    """The virtual clock (`time`, ns), the tasks that wait for an instant and those that are ready now."""

    def __init__(self) -> None:
        self.time = 0
        self.failure: BaseException | None = None
        self._sleeping: list[tuple[int, int, Task, int]] = []
        self._ready: deque[Callable[[], None]] = deque()
        self._sequence = 0
        self._running: Task | None = None

    def wait(self, until: int | None = None) -> bool:
        """Hand over until the instant `until` or until woken; tell whether woken. Called within a task."""
        task = current_task()
        task.parked = True
        if until is not None:
            self._sequence += 1
            heappush(self._sleeping, (until, self._sequence, task, task.ticket))
        parent = task.parent
        assert parent is not None
        return bool(parent.switch())

    def wake(self, task: Task) -> None:
        """Resume a waiting task as soon as the running one waits."""
        if task.parked:
            task.parked = False
            task.ticket += 1
            self._ready.append(lambda: self._resume(task, True))

    def spawn(self, process: Process, function: Callable[..., Any], *args: Any, main: bool = False) -> Task:
        """Start a task: at once when called from outside, when the running task waits otherwise."""
        task = Task(process, function, main=main)
        process.tasks.append(task)
        if main:
            process.main = task
        if isinstance(getcurrent(), Task):
            self._ready.append(lambda: self._resume(task, *args))
        else:
            self._resume(task, *args)
        return task

    def later(self, job: Callable[[], None]) -> None:
        """Do something outside of all tasks, as soon as the running one waits."""
        self._ready.append(job)

    def settle(self) -> None:
        """Run everything that is ready now."""
        while self._ready and self.failure is None:
            self._ready.popleft()()

    def advance(self, until: int) -> None:
        """Move the clock to `until`, running what falls due in the order of its instants."""
        self.settle()
        sleeping = self._sleeping
        while sleeping and sleeping[0][0] <= until and self.failure is None:
            time, _, task, ticket = heappop(sleeping)
            if ticket != task.ticket or task.dead:
                continue
            if time > self.time:
                self.time = time
                WATCHDOG.beat()
            task.parked = False
            self._resume(task, False)
            if self._ready:
                self.settle()
        if self.failure is None:
            self.time = until

    def kill(self, task: Task) -> None:
        """End a task wherever it waits."""
        task.ticket += 1
        if task.gr_frame is None and not task.dead:
            task.process.finished(task)  # never started: there is nothing to unwind
        elif not task.dead:
            task.parent = getcurrent()
            task.throw(GreenletExit)

    def spinning(self) -> NodeError:
        """Blame the task that ran last for never waiting."""
        task = self._running
        place = blame.of_frame(task.gr_frame) if task is not None else None
        return task.process.spins(place) if task is not None else NodeError("A node never waits.")

    def _resume(self, task: Task, *args: Any) -> None:
        if task.dead:
            return
        task.ticket += 1
        task.parent = getcurrent()
        self._running = task
        task.switch(*args)


__all__ = ["Scheduler", "Spinning", "Task", "current_task"]
