"""Lock-step: count sent messages, and let no node continue before all have arrived.

Messages travel by a real network, in threads of the client library; this is where they come back into the one
sequence that the scheduler plays.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from pytest_tarl.errors import RecordingError
from pytest_tarl.ros.process import Process
from pytest_tarl.ros.scheduler import Scheduler, Task

PATIENCE = 10.0  # seconds of wall time for something to cross the loopback device


class Way(NamedTuple):
    """One connection: what is sent on it arrives in order."""

    topic: str
    sender: str
    receiver: str


class Wire:
    """Messages under way. `expect` and `take` belong to the test's thread, `arrived` to any."""

    def __init__(self) -> None:
        self._arrival = threading.Condition()
        self._boxes: dict[Way, deque[Any]] = {}
        self._expected: deque[Way] = deque()

    def expect(self, way: Way) -> None:
        """Note that a message was sent."""
        self._expected.append(way)

    def arrived(self, way: Way, message: Any) -> None:
        """Take in a message."""
        with self._arrival:
            self._boxes.setdefault(way, deque()).append(message)
            self._arrival.notify()

    def take(self) -> tuple[Way, Any] | None:
        """Return what was sent first, as soon as it is here; None when nothing is under way. Raises RecordingError."""
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
        """Wait until everything that was sent this way is here, so that no queue on the way can overflow."""
        count = self._expected.count(way)
        if count:
            with self._arrival:
                self._arrival.wait_for(lambda: len(self._boxes.get(way, ())) >= count, PATIENCE)

    def forget(self) -> None:
        """Drop everything under way: the episode is over."""
        while self._expected:
            self.take()
        with self._arrival:
            self._boxes.clear()


class WireScheduler(Scheduler):
    """A scheduler that settles only when nothing is under way any more."""

    def __init__(self) -> None:
        super().__init__()
        self.collect: Callable[[], bool] = bool  # takes in one message; tells whether there was one
        self.enter: Callable[[Process], None] | None = None  # called before a task of a process goes on

    def settle(self) -> None:
        """Run everything that is ready now and everything that arrives from it."""
        super().settle()
        while self.failure is None and self.collect():
            super().settle()

    def sent(self) -> None:
        """Have the scheduler settle once more before time goes on."""
        self.later(_nothing)

    def _resume(self, task: Task, woken: bool) -> None:
        if self.enter is not None and not task.done and isinstance(task.process, Process):
            self.enter(task.process)
        super()._resume(task, woken)


def _nothing() -> None:
    """Do nothing: that something was sent is all there is to tell."""
