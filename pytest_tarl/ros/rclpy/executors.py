"""rclpy's executors: they wait for what becomes ready in their nodes and run its callbacks."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

import inspect
from collections import deque
from typing import TYPE_CHECKING, Any, Protocol

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.rclpy.context import Context
from pytest_tarl.ros.rclpy.task import Future, Task
from pytest_tarl.ros.scheduler import Task as RunningTask
from pytest_tarl.ros.scheduler import current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


class Entity(Protocol):
    """Something of a node that an executor can run when it is ready."""

    callback_group: Any

    def is_ready(self) -> bool:
        """Tell whether there is something to do."""

    def run(self) -> Any:
        """Do it; a coroutine is returned for the executor to go on with."""


class ExternalShutdownException(Exception):  # noqa: N818 (these names are rclpy's)
    """The context was shut down while an executor waited."""

    tarl_shutdown = True


class ShutdownException(Exception):  # noqa: N818
    """The executor was shut down."""


class TimeoutException(Exception):  # noqa: N818
    """Nothing became ready in time."""


class ConditionReachedException(Exception):  # noqa: N818
    """What was waited for has happened."""


class Executor:
    """Runs one callback at a time, in the task that spins."""

    def __init__(self, *, context: Any = None) -> None:
        self.process = current_process("rclpy.executors.Executor")
        self.context: Context = self.process.part(Context)
        self._clock = self.process.scheduler
        self._nodes: list[Node] = []
        self._tasks: list[Task] = []
        self._batch: deque[Entity] = deque()
        self._waiting: list[RunningTask] = []
        self._is_shutdown = False
        self.context.on_wake(self.wake)

    def add_node(self, node: Node) -> bool:
        """Take a node over; tell whether it is new here."""
        if node in self._nodes:
            return False
        self._nodes.append(node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """Let a node go."""
        if node in self._nodes:
            self._nodes.remove(node)
            node.executor = None

    def get_nodes(self) -> list[Node]:
        """List the nodes."""
        return list(self._nodes)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Have a function or coroutine run when the executor comes to it."""
        task = Task(callback, args, kwargs, self)
        self._tasks.append(task)
        self.wake()
        return task

    def wake(self) -> None:
        """Look again for what is ready."""
        for task in self._waiting:
            self._clock.wake(task)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop spinning."""
        self._is_shutdown = True
        self._batch.clear()
        for node in tuple(self._nodes):
            self.remove_node(node)
        self.wake()
        return True

    def spin(self) -> None:
        """Run callbacks until ROS is shut down."""
        while self.context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback, waiting up to `timeout_sec` for it (None: as long as it takes)."""
        work = self._next_work(timeout_sec, None)
        if work is not None:
            self._run(work)

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done, or the timeout has passed."""
        until = _until(self._clock.time, timeout_sec)
        future.add_done_callback(lambda _: self.wake())
        while self.context.ok() and not future.done() and not future.cancelled() and not self._is_shutdown:
            if until is not None and self._clock.time >= until:
                return
            self._spin_towards(future, until)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run one callback, unless the future is done before."""
        future.add_done_callback(lambda _: self.wake())
        self._spin_towards(future, _until(self._clock.time, timeout_sec))

    def _spin_towards(self, future: Future, until: int | None) -> None:
        remaining = None if until is None else (until - self._clock.time) / 1e9
        work = self._next_work(remaining, future)
        if work is not None:
            self._run(work)

    def _next_work(self, timeout_sec: float | None, future: Future | None) -> Entity | None:
        until = _until(self._clock.time, timeout_sec)
        while True:
            if self.process.ending:
                raise ExternalShutdownException
            if not self.context.ok() or self._is_shutdown or (future is not None and future.done()):
                return None
            work = self._pop()
            if work is not None:
                return work
            if until is not None and self._clock.time >= until:
                return None
            self._wait(until)

    def _pop(self) -> Entity | None:
        """Take the next of what was ready at the last look; look again when that is used up."""
        entity = self._next_in_batch()
        if entity is None:
            self._batch.extend(self._ready())
            entity = self._next_in_batch()
        return entity

    def _next_in_batch(self) -> Entity | None:
        while self._batch:
            entity = self._batch.popleft()
            group = entity.callback_group
            if entity.is_ready() and (group is None or group.can_execute(entity)):
                return entity
        return None

    def _ready(self) -> list[Entity]:
        """List what is ready, in rclpy's order: tasks, then per node timers, subscriptions, clients, services."""
        if self._tasks:
            self._tasks = [task for task in self._tasks if not task.done() and not task.cancelled()]
        found: list[Entity] = [task for task in self._tasks if task.is_ready()]
        for node in self._nodes:
            found += [entity for entity in node.entities() if entity.is_ready()]
        return found

    def _wait(self, until: int | None) -> None:
        due = [timer.due for node in self._nodes for timer in node.timers_ if not timer.is_canceled()]
        if until is not None:
            due.append(until)
        earliest = min((instant for instant in due if instant > self._clock.time), default=None)
        task = current_task()
        self._waiting.append(task)
        try:
            self._clock.wait(earliest)
        finally:
            self._waiting.remove(task)

    def _run(self, work: Entity) -> None:
        group = work.callback_group
        if group is not None:
            group.running += 1
        try:
            outcome = work.run()
        finally:
            if group is not None:
                group.running -= 1
        if inspect.iscoroutine(outcome):
            self.create_task(outcome)

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()


class SingleThreadedExecutor(Executor):
    """Runs one callback at a time."""


class EventsExecutor(Executor):
    """Runs one callback at a time."""


class MultiThreadedExecutor(Executor):
    """Runs callbacks beside each other, as far as their groups allow: one that waits does not hold up the rest."""

    def __init__(self, num_threads: int | None = None, *, context: Any = None) -> None:
        super().__init__(context=context)
        self._limit = num_threads or 64
        self._active = 0

    def _pop(self) -> Entity | None:
        return super()._pop() if self._active < self._limit else None

    def _run(self, work: Entity) -> None:
        """Start a callback in a task of its own and let it run until it waits."""
        group = work.callback_group
        if group is not None:
            group.running += 1
        self._active += 1
        self._clock.spawn(self.process, self._run_beside, work, group)
        self._clock.yield_now()

    def _run_beside(self, work: Entity, group: Any) -> None:
        try:
            outcome = work.run()
        finally:
            self._active -= 1
            if group is not None:
                group.running -= 1
            self.wake()
        if inspect.iscoroutine(outcome):
            self.create_task(outcome)


def _until(now: int, timeout_sec: float | None) -> int | None:
    return None if timeout_sec is None or timeout_sec < 0 else now + nanoseconds(timeout_sec)
