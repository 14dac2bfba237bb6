"""rospy's times, durations, rates, sleep and timers, all on the virtual clock."""

# ruff: noqa: ARG002 (signatures are rospy's)

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pytest_tarl.ros.clock import NANOSECONDS, seconds
from pytest_tarl.ros.clock import nanoseconds as to_nanoseconds
from pytest_tarl.ros.messages import times
from pytest_tarl.ros.polling import asked
from pytest_tarl.ros.rospy.exceptions import ROSInterruptException
from pytest_tarl.ros.rospy.node import RospyNode, this_node


class Duration(times.Duration):
    """A duration."""

    __slots__: list[str] = []

    def __repr__(self) -> str:
        return f"rospy.Duration[{self.to_nsec()}]"


class Time(times.Time):
    """A time on the virtual clock."""

    __slots__: list[str] = []

    def __repr__(self) -> str:
        return f"rospy.Time[{self.to_nsec()}]"

    @staticmethod
    def now() -> Time:
        """Return the current time."""
        return get_rostime()

    @classmethod
    def from_seconds(cls, float_secs: float) -> Time:
        """Create a time from float seconds."""
        return cls(float(float_secs))


def get_rostime() -> Time:
    """Return the current time. Raise ROSInitException before init_node."""
    node = this_node("get_rostime")
    node.require()
    asked()
    return Time(*divmod(node.process.scheduler.time, NANOSECONDS))


def get_time() -> float:
    """Return the current time in float seconds."""
    node = this_node("get_time")
    node.require()
    asked()
    return seconds(node.process.scheduler.time)


def sleep(duration: Any) -> None:
    """Wait for a Duration or a number of seconds. Raise ROSInterruptException when the node is shut down."""
    node = this_node("sleep")
    node.require()
    span = duration.to_nsec() if isinstance(duration, times.Duration) else to_nanoseconds(duration)
    _sleep_until(node, node.process.scheduler.time + span)


def _sleep_until(node: RospyNode, until: int) -> None:
    process = node.process
    if process.ending:
        process.refuse_to_wait()
    if process.ending and node.in_hooks:
        return  # virtual time stands still in shutdown hooks
    if until <= process.scheduler.time:
        asked()
    if until >= process.scheduler.time and not process.ending:
        process.scheduler.wait(until)
    if process.ending:
        raise ROSInterruptException("ROS shutdown request")


class Rate:
    """Keeps a loop at a frequency in Hz."""

    def __init__(self, hz: float, reset: bool = False) -> None:
        self._node = this_node("Rate")
        self._node.require()
        self._clock = self._node.process.scheduler
        self._last = self._clock.time
        self._period = int(NANOSECONDS / hz)
        self._reset = reset

    @property
    def sleep_dur(self) -> Duration:
        """Return the length of a cycle."""
        return Duration(0, self._period)

    @property
    def last_time(self) -> Time:
        """Return the start of the current cycle."""
        return Time(0, self._last)

    def remaining(self) -> Duration:
        """Return how much time is left in the current cycle."""
        return Duration(0, self._period - (self._clock.time - self._last))

    def sleep(self) -> None:
        """Wait until the current cycle ends; catch up on at most two late cycles.

        Raise ROSInterruptException when the node is shut down.
        """
        began = self._clock.time
        until = self._last + self._period
        if until > began:
            _sleep_until(self._node, until)
        elif self._node.process.ending:
            self._node.process.refuse_to_wait()
            raise ROSInterruptException("ROS shutdown request")
        self._last = until
        if began - until > 2 * self._period:
            self._last = began


@dataclass
class TimerEvent:
    """The argument of timer callbacks; times are rospy.Time, `last_duration` is in float seconds."""

    last_expected: Time | None
    last_real: Time | None
    current_expected: Time | None
    current_real: Time | None
    last_duration: float | None


class Timer:
    """Calls `callback(TimerEvent)` every `period` (a Duration)."""

    daemon = True

    def __init__(
        self,
        period: Any,
        callback: Callable[[TimerEvent], Any],
        oneshot: bool = False,
        reset: bool = False,
    ) -> None:
        self._node = this_node("Timer")
        self._node.require()
        self._callback = callback
        self._oneshot = oneshot
        self._period: int = period.to_nsec()
        if self._period <= 0:
            raise ValueError(f"a timer needs a period above zero, not {period.to_sec()} s")
        self._stopped = False
        self._task = self._node.process.scheduler.spawn(self._node.process, self._run)

    def shutdown(self) -> None:
        """Stop the timer."""
        self._stopped = True
        self._node.process.scheduler.wake(self._task)

    def is_alive(self) -> bool:
        """Return whether the timer is still running."""
        return not self._task.done and not self._stopped

    def join(self, timeout: float | None = None) -> None:
        """Wait until the timer has ended, as for a thread."""
        clock = self._node.process.scheduler
        until = None if timeout is None else clock.time + to_nanoseconds(timeout)
        while self.is_alive() and not self._node.process.ending and (until is None or clock.time < until):
            clock.wait(
                min(clock.time + self._period, until) if until is not None else clock.time + self._period
            )

    def _run(self) -> None:
        process = self._node.process
        clock = process.scheduler
        due = clock.time + self._period
        expected: Time | None = None
        real: Time | None = None
        duration: float | None = None
        while not (self._stopped or process.ending):
            if due > clock.time and clock.wait(due):
                continue  # a shutdown ended the wait early
            began = clock.time
            now_expected, now_real = Time(0, due), Time(0, began)
            self._callback(TimerEvent(expected, real, now_expected, now_real, duration))
            if self._oneshot:
                break
            expected, real, duration = now_expected, now_real, seconds(clock.time - began)
            due += self._period
            if clock.time - due > self._period:
                due = clock.time


def is_wallclock() -> bool:
    """Return False: the time is that of the episode."""
    return False


def switch_to_wallclock() -> None:
    """Do nothing: there is no other clock."""


def is_rostime_initialized() -> bool:
    """Return whether `init_node` was called."""
    return this_node("rostime.is_rostime_initialized").initialised


def set_rostime_initialized(val: bool) -> None:
    """Do nothing: `init_node` initialises the time."""


def wallsleep(duration: float) -> None:
    """Wait for seconds of the virtual clock, as `time.sleep` does in nodes."""
    if duration > 0:
        time.sleep(duration)


def wallclock() -> float:
    """Return the virtual time in float seconds: there is no other clock."""
    return get_time()
