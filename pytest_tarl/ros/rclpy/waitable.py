"""What executors can run besides topics, services and timers: guard conditions, and letters for actions."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


class GuardCondition:
    """Has its callback run by the executor after `trigger`, however often it was triggered."""

    def __init__(self, node: Node, callback: Callable[[], Any] | None, group: Any) -> None:
        self.node = node
        self.callback = callback
        self.callback_group = group
        self._triggered = False

    def trigger(self) -> None:
        """Ask for the callback."""
        self._triggered = True
        self.node.notify()

    def is_ready(self) -> bool:
        """Tell whether it was triggered since the callback last ran."""
        return self._triggered

    def run(self) -> Any:
        """Call the callback."""
        self._triggered = False
        return self.callback() if self.callback is not None else None

    def destroy(self) -> None:
        """Forget it."""
        self._triggered = False


class Mailbox:
    """Jobs that others ask of a node; its executor does them one by one, in the order in which they came."""

    def __init__(self, node: Node, group: Any) -> None:
        self.node = node
        self.callback_group = group
        self._jobs: deque[tuple[Callable[..., Any], tuple[Any, ...]]] = deque()

    def post(self, job: Callable[..., Any], *args: Any) -> None:
        """Ask for a job."""
        self._jobs.append((job, args))
        self.node.notify()

    def is_ready(self) -> bool:
        """Tell whether a job waits."""
        return bool(self._jobs)

    def run(self) -> Any:
        """Do the oldest job."""
        job, args = self._jobs.popleft()
        return job(*args)

    def destroy(self) -> None:
        """Forget all jobs."""
        self._jobs.clear()
