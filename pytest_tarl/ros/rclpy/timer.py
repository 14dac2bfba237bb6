"""rclpy's timers and rates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pytest_tarl.ros.clock import NANOSECONDS
from pytest_tarl.ros.rclpy.exceptions import ROSInterruptException
from pytest_tarl.ros.rclpy.time import Time

if TYPE_CHECKING:
    from pytest_tarl.ros.rclpy.node import Node


@dataclass(frozen=True)
class TimerInfo:
    """When a timer's callback was due, and when it was called."""

    expected_call_time: Time
    actual_call_time: Time


class Timer:
    """Is ready every `period` nanoseconds; periods that an executor misses are skipped."""

    def __init__(
        self, node: Node, period: int, callback: Callable[..., Any] | None, group: Any, clock: Any = None
    ) -> None:
        self.node = node
        self.clock = clock if clock is not None else node.get_clock()
        self.callback = callback
        self.callback_group = group
        self.timer_period_ns = period
        self._clock = node.process.scheduler
        self.canceled = False
        self._last = self._clock.time
        self.due = self._clock.time + period

    def is_ready(self) -> bool:
        """Return whether the timer is due."""
        return not self.canceled and self._clock.time >= self.due

    def is_canceled(self) -> bool:
        """Return whether the timer was cancelled."""
        return self.canceled

    def cancel(self) -> None:
        """Stop until `reset`."""
        self.canceled = True

    def reset(self) -> None:
        """Start a new period now, even after `cancel`."""
        self.canceled = False
        self.due = self._clock.time + self.timer_period_ns
        self.node.notify()

    def time_since_last_call(self) -> int:
        """Return the nanoseconds since the last call, or since the timer started."""
        return self._clock.time - self._last

    def time_until_next_call(self) -> int | None:
        """Return the nanoseconds until the timer is ready; None while it is cancelled."""
        return None if self.canceled else self.due - self._clock.time

    def destroy(self) -> None:
        """Stop the timer for good."""
        self.cancel()

    def run(self) -> Any:
        """Skip to the next period that ends in the future, then call the callback."""
        expected, self._last = self.due, self._clock.time
        self._begin_period()
        callback = self._callback
        if callback is None:
            return None
        return callback() if self._told_as is None else callback(**{self._told_as: self._info(expected)})

    @property
    def callback(self) -> Callable[..., Any] | None:
        """Return the callback; if it has a parameter annotated as TimerInfo, this is passed."""
        return self._callback

    @callback.setter
    def callback(self, callback: Callable[..., Any] | None) -> None:
        self._callback = callback
        self._told_as = _told_as(callback) if callback is not None else None

    def _info(self, expected: int) -> TimerInfo:
        kind = self.clock.clock_type
        return TimerInfo(Time(nanoseconds=expected, clock_type=kind),
                         Time(nanoseconds=self._last, clock_type=kind))  # fmt: skip

    def _begin_period(self) -> None:
        self.due += self.timer_period_ns
        behind = self._clock.time - self.due
        if behind >= 0 and self.timer_period_ns > 0:
            self.due += (1 + behind // self.timer_period_ns) * self.timer_period_ns


def _told_as(callback: Callable[..., Any]) -> str | None:
    if not getattr(callback, "__annotations__", None):
        return None
    for name, kind in callback.__annotations__.items():
        if kind is TimerInfo or str(kind).rpartition(".")[2] == "TimerInfo":
            return name
    return None


class Rate:
    """Keeps a loop at a frequency in Hz. Unlike in rclpy, no second thread has to spin."""

    def __init__(self, node: Node, frequency: float) -> None:
        self._process = node.process
        self._period = int(NANOSECONDS / frequency)
        self._due = self._process.scheduler.time + self._period

    def sleep(self) -> None:
        """Wait until the cycle ends. Raise ROSInterruptException when the node is shut down."""
        clock = self._process.scheduler
        while clock.time < self._due and not self._process.ending:
            clock.wait(self._due)
        if self._process.ending:
            raise ROSInterruptException
        self._due += self._period
        if self._due <= clock.time:
            self._due += (1 + (clock.time - self._due) // self._period) * self._period

    def destroy(self) -> None:
        """Stop the rate for good."""
