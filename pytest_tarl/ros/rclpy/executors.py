"""rclpy's executors: wait for entities of their nodes to become ready, and run their callbacks."""

# ruff: noqa: ARG002 (signatures are rclpy's)

from __future__ import annotations

import inspect
from collections import deque
from typing import TYPE_CHECKING, Any, Protocol

from pytest_tarl.ros.clock import nanoseconds
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.process import current_process
from pytest_tarl.ros.rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from pytest_tarl.ros.rclpy.context import Context
from pytest_tarl.ros.rclpy.task import Future, Task
from pytest_tarl.ros.scheduler import Task as RunningTask
from pytest_tarl.ros.scheduler import current_task

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


class Entity(Protocol):
    """The interface of a node's entity that an executor can run."""

    callback_group: Any

    def is_ready(self) -> bool:
        """Return whether there is work."""

    def run(self) -> Any:
        """Do the work; return a coroutine if the executor must continue it."""


class ExternalShutdownException(Exception):  # noqa: N818 (these names are rclpy's)
    """The context was shut down while an executor waited."""

    tarl_shutdown = True


class ShutdownException(Exception):  # noqa: N818
    """The executor was shut down."""


class TimeoutException(Exception):  # noqa: N818
    """Nothing became ready in time."""


class ConditionReachedException(Exception):  # noqa: N818
    """The awaited condition holds."""


class Executor:
    """Runs one callback at a time in the spinning task."""

    def __init__(self, *, context: Any = None) -> None:
        self.process = current_process("rclpy.executors.Executor")
        self.context: Context = self.process.part(Context)
        self._clock = self.process.scheduler
        self._nodes: list[Node] = []
        self._tasks: list[Task] = []
        self._batch: deque[Entity] = deque()
        self._waiting: list[RunningTask] = []
        # whether an entity other than a timer may have become ready since the last check
        self._stirred = True
        self._is_shutdown = False
        self._active, self._limit = 0, 1  # number of running callbacks, and its limit
        self.context.on_wake(self.wake)

    def add_node(self, node: Node) -> bool:
        """Add a node; return whether it is new."""
        if node in self._nodes:
            return False
        if node.executor is not None:
            node.executor.remove_node(node)
        self._nodes.append(node)
        node.take_executor(self)
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """Remove a node."""
        if node in self._nodes:
            self._nodes.remove(node)
            node.take_executor(None)

    def get_nodes(self) -> list[Node]:
        """Return the nodes."""
        return list(self._nodes)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Queue a function or coroutine."""
        task = Task(callback, args, kwargs, self)
        self._tasks.append(task)
        self.wake()
        return task

    def create_future(self) -> Future:
        """Create a future whose callbacks this executor runs."""
        return Future(executor=self)

    def wake(self) -> None:
        """Check again for ready entities."""
        self._stirred = True
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
            work = self._next_work(None, None)
            if work is not None:
                self._run(work)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback; wait for it up to `timeout_sec` (None: no limit)."""
        work = self._next_work(_until(self._clock.time, timeout_sec), None)
        if work is not None:
            self._run(work)
        elif timeout_sec is not None and timeout_sec <= 0:
            asked()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done or the timeout has passed."""
        until = _until(self._clock.time, timeout_sec)
        future.watch(self.wake)
        future.add_done_callback(_nothing)
        while self.context.ok() and not future.done() and not self._is_shutdown:
            if until is not None and self._clock.time >= until:
                return
            self._spin_towards(future, until)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run one callback, unless the future is done."""
        future.watch(self.wake)
        future.add_done_callback(_nothing)
        self._spin_towards(future, _until(self._clock.time, timeout_sec))

    def _spin_towards(self, future: Future, until: int | None) -> None:
        work = self._next_work(until, future)
        if work is not None:
            self._run(work)

    def _next_work(self, until: int | None, future: Future | None) -> Entity | None:
        batch, clock = self._batch, self._clock
        while True:
            if self.process.ending:
                raise ExternalShutdownException
            if not self.context.initialised or self._is_shutdown or (future is not None and future.done()):
                return None
            # check for ready entities once per round; a rejected entity waits for the next round
            looked = False
            while self._active < self._limit:
                if not batch:
                    if looked or not self._look():
                        break
                    looked = True
                entity = batch.popleft()
                if entity.is_ready() and self._begins(entity):
                    return entity
            if until is not None and clock.time >= until:
                return None
            self._wait(until)

    def _begins(self, entity: Entity) -> bool:
        """Return whether the entity's group lets its callback start now."""
        group = entity.callback_group
        if type(group) is MutuallyExclusiveCallbackGroup and group.active is None:
            group.active = entity  # a faster equivalent of the two calls below
            return True
        if group is None or (group.can_execute(entity) and group.beginning_execution(entity)):
            return True
        # check again in the next round: a custom group may then decide differently
        self._stirred = True
        return False

    def _look(self) -> bool:
        """Collect ready timers and, if anything may have changed, other ready entities; return whether any is ready."""
        if self._stirred:
            self._stirred = False
            self._batch.extend(self._ready())
            return bool(self._batch)
        now = self._clock.time
        for node in self._nodes:
            for timer in node.timers_:
                if timer.due <= now and timer.is_ready():
                    self._batch.append(timer)
        return bool(self._batch)

    def _ready(self) -> list[Entity]:
        """Return the ready entities in rclpy's order: tasks, then the entities of each node by kind."""
        found: list[Entity] = []
        if self._tasks:
            self._tasks = [task for task in self._tasks if task.pending()]
            found += [task for task in self._tasks if task.is_ready()]
        for node in self._nodes:
            for kind in node.entities:
                found += [entity for entity in kind if entity.is_ready()]
        return found

    def _wait(self, until: int | None) -> None:
        earliest, now = until, self._clock.time
        for node in self._nodes:
            for timer in node.timers_:
                due = timer.due
                if due > now and (earliest is None or due < earliest) and not timer.canceled:
                    earliest = due
        task = current_task()
        self._waiting.append(task)
        try:
            self._clock.wait(earliest)
        finally:
            self._waiting.remove(task)

    def _run(self, work: Entity) -> None:
        group = work.callback_group
        outcome = None
        try:
            outcome = work.run()
        finally:
            if group is not None and outcome is None:
                group.ending_execution(work)
        if outcome is not None:
            self._go_on(outcome, work)
        if work.is_ready():
            self._stirred = True  # check again in the next round: the coroutine has not ended

    def _go_on(self, outcome: Any, work: Entity) -> None:
        """Continue a callback's coroutine; its group stays occupied until it returns."""
        if inspect.iscoroutine(outcome):
            going_on = self.create_task(outcome)
            if work.callback_group is not None:
                going_on.watch(lambda: self._ended(work))
        elif work.callback_group is not None:
            work.callback_group.ending_execution(work)

    def _ended(self, work: Entity) -> None:
        work.callback_group.ending_execution(work)
        self.wake()

    def __enter__(self) -> Executor:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()


class SingleThreadedExecutor(Executor):
    """Runs one callback at a time."""


class EventsExecutor(Executor):
    """Runs one callback at a time."""


class MultiThreadedExecutor(Executor):
    """Runs callbacks at the same time where their groups allow it; a waiting callback does not block others."""

    def __init__(self, num_threads: int | None = None, *, context: Any = None) -> None:
        super().__init__(context=context)
        self._limit = num_threads or 64

    def _next_work(self, until: int | None, future: Future | None) -> Entity | None:
        try:
            return super()._next_work(until, future)
        except ExternalShutdownException:  # spin returns, as in rclpy
            return None

    def _run(self, work: Entity) -> None:
        """Start a callback in its own task, which runs until it waits."""
        self._active += 1
        self._clock.spawn(self.process, self._run_beside, work)
        self._clock.yield_now()
        if work.is_ready():
            self._stirred = True

    def _run_beside(self, work: Entity) -> None:
        try:
            super()._run(work)
        finally:
            self._active -= 1
            self.wake()


def _nothing(_: Future) -> None:
    """Replace rclpy's callback that wakes the executor, so that done callbacks take as many turns as in rclpy."""


def _until(now: int, timeout_sec: float | None) -> int | None:
    return None if timeout_sec is None or timeout_sec < 0 else now + nanoseconds(timeout_sec)
