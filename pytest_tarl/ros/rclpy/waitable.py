"""Entities other than topics, services and timers: guard conditions, and mailboxes for actions."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


class GuardCondition:
    """Makes the executor run its callback once, however often `trigger` is called."""

    def __init__(self, node: Node, callback: Callable[[], Any] | None, group: Any) -> None:
        self.node = node
        self.callback = callback
        self.callback_group = group
        self._triggered = False

    def trigger(self) -> None:
        """Request a call of the callback."""
        self._triggered = True
        self.node.notify()

    def is_ready(self) -> bool:
        """Return whether `trigger` was called since the callback last ran."""
        return self._triggered

    def run(self) -> Any:
        """Call the callback."""
        self._triggered = False
        return self.callback() if self.callback is not None else None

    def destroy(self) -> None:
        """Forget the trigger."""
        self._triggered = False


class Mailbox:
    """A node's queue of jobs; the executor runs them one by one, oldest first."""

    def __init__(self, node: Node, group: Any) -> None:
        self.node = node
        self.callback_group = group
        self._jobs: deque[tuple[Callable[..., Any], tuple[Any, ...]]] = deque()

    def post(self, job: Callable[..., Any], *args: Any) -> None:
        """Queue a job."""
        self._jobs.append((job, args))
        self.node.notify()

    def is_ready(self) -> bool:
        """Return whether a job is queued."""
        return bool(self._jobs)

    def run(self) -> Any:
        """Run the oldest job."""
        job, args = self._jobs.popleft()
        return job(*args)

    def destroy(self) -> None:
        """Discard all jobs."""
        self._jobs.clear()
