"""rclpy's timers and rates."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.rclpy.exceptions import ROSInterruptException

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


class Timer:
    """Becomes ready every `period` nanoseconds; an executor that is late skips what it missed."""

    def __init__(self, node: Node, period: int, callback: Callable[..., Any] | None, group: Any) -> None:
        self.node = node
        self.callback = callback
        self.callback_group = group
        self.timer_period_ns = period
        self._clock = node.process.scheduler
        self._canceled = False
        self.due = self._clock.time + period

    def is_ready(self) -> bool:
        """Tell whether it is time."""
        return not self._canceled and self._clock.time >= self.due

    def is_canceled(self) -> bool:
        """Tell whether it was cancelled."""
        return self._canceled

    def cancel(self) -> None:
        """Stop until `reset`."""
        self._canceled = True

    def reset(self) -> None:
        """Start a new period now."""
        self._canceled = False
        self.due = self._clock.time + self.timer_period_ns
        self.node.notify()

    def time_since_last_call(self) -> int:
        """Return nanoseconds since the present period began."""
        return self._clock.time - (self.due - self.timer_period_ns)

    def time_until_next_call(self) -> int | None:
        """Return nanoseconds until it is ready; None while cancelled."""
        return None if self._canceled else self.due - self._clock.time

    def destroy(self) -> None:
        """Forget it."""
        self.cancel()

    def run(self) -> Any:
        """Begin the next period that is not over yet and call the callback."""
        self._begin_period()
        return self.callback() if self.callback is not None else None

    def _begin_period(self) -> None:
        self.due += self.timer_period_ns
        behind = self._clock.time - self.due
        if behind >= 0 and self.timer_period_ns > 0:
            self.due += (1 + behind // self.timer_period_ns) * self.timer_period_ns


class Rate:
    """Keeps a loop at a frequency. Waits by itself, so it works without a second thread that spins."""

    def __init__(self, node: Node, frequency: float) -> None:
        self._process = node.process
        self._period = int(NANOSECONDS / frequency)
        self._due = self._process.scheduler.time + self._period

    def sleep(self) -> None:
        """Wait for the end of the cycle. Raises ROSInterruptException when the node is shut down."""
        clock = self._process.scheduler
        while clock.time < self._due and not self._process.ending:
            clock.wait(self._due)
        if self._process.ending:
            raise ROSInterruptException
        self._due += self._period
        if self._due <= clock.time:
            self._due += (1 + (clock.time - self._due) // self._period) * self._period

    def destroy(self) -> None:
        """Forget it."""
