"""Lock-step: count sent messages, and resume nodes only after all of them have arrived.

Messages pass through a real network and arrive in threads of the client library. This module restores the deterministic
order of the scheduler.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Scheduler, Task

PATIENCE = 10.0  # maximum wall time to wait for a message (s)


class Way(NamedTuple):
    """A connection from a sender to a receiver; messages arrive in the order in which they were sent."""

    topic: str
    sender: str
    receiver: str


class Wire:
    """The messages in transit. `expect` and `take` belong to the test's thread; any thread may call `arrived`."""

    def __init__(self) -> None:
        self._arrival = threading.Condition()
        self._boxes: dict[Way, deque[Any]] = {}
        self._expected: deque[Way] = deque()

    def expect(self, way: Way) -> None:
        """Count a sent message."""
        self._expected.append(way)

    def arrived(self, way: Way, message: Any) -> None:
        """Store a received message."""
        with self._arrival:
            self._boxes.setdefault(way, deque()).append(message)
            self._arrival.notify()

    def take(self) -> tuple[Way, Any] | None:
        """Wait for the message that was sent first and return it; return None if there is none in transit.

        Raise RecordingError if the message does not arrive within PATIENCE.
        """
        if not self._expected:
            return None
        way = self._expected.popleft()
        with self._arrival:
            if not self._arrival.wait_for(lambda: self._boxes.get(way), PATIENCE):
                raise RecordingError(
                    f"A message from {way.sender} to {way.receiver} on {way.topic} did not arrive within "
                    f"{PATIENCE:g} s: check that processes on this machine can communicate through 127.0.0.1."
                )
            return way, self._boxes[way].popleft()

    def wait_for_all(self, way: Way) -> None:
        """Wait until all messages sent on a connection have arrived, so that no queue overflows."""
        count = self._expected.count(way)
        if count:
            with self._arrival:
                self._arrival.wait_for(lambda: len(self._boxes.get(way, ())) >= count, PATIENCE)

    def forget(self) -> None:
        """Discard all messages in transit at the end of an episode."""
        while self._expected:
            self.take()
        with self._arrival:
            self._boxes.clear()


class WireScheduler(Scheduler):
    """A scheduler that settles only when no message is in transit."""

    def __init__(self) -> None:
        super().__init__()
        # receives one message in transit, and returns whether there was one
        self.collect: Callable[[], bool] = bool
        self.enter: Callable[[Process], None] | None = None  # called before a task of a process is resumed

    def settle(self) -> None:
        """Run ready tasks, including those that messages make ready, until no message is in transit."""
        super().settle()
        while self.failure is None and self.collect():
            super().settle()

    def sent(self) -> None:
        """Make the scheduler settle again before time advances."""
        self.later(_nothing)

    def _resume(self, task: Task, woken: bool, error: BaseException | None = None) -> None:
        if self.enter is not None and not task.done and isinstance(task.process, Process):
            self.enter(task.process)
        super()._resume(task, woken, error)


def _nothing() -> None:
    """Do nothing; queueing this makes the scheduler settle again."""
