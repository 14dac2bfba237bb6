"""Signals of nodes: handlers, alarms, and signals to their own process; other code keeps the real ones.

A node runs inside pytest. Its real handlers would replace pytest's, so that Ctrl-C would no longer stop the run. An
alarm, or a real signal to its own process, would end pytest.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from math import ceil
from typing import Any, NoReturn

from greenlet import GreenletExit

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros.clock import nanoseconds, seconds
from pytest_tarl.ros.exiting import ProcessExit
from pytest_tarl.ros.process import Process, running_process
from pytest_tarl.ros.scheduler import Task, running_task

# when a signal ends a process, a shell shows this number plus that of the signal as its exit status
_BY_A_SIGNAL = 128
_HARMLESS = frozenset(
    getattr(signal, name)
    for name in ("SIGCHLD", "SIGCONT", "SIGSTOP", "SIGTSTP", "SIGTTIN", "SIGTTOU", "SIGURG", "SIGWINCH")
    if hasattr(signal, name)
)
_UNCHANGEABLE = frozenset(getattr(signal, name) for name in ("SIGKILL", "SIGSTOP") if hasattr(signal, name))


class _Signals:
    """The signal handlers and the alarm of a process; times are virtual, in ns."""

    def __init__(self, process: Process) -> None:
        self.process = process
        self.handlers: dict[int, Any] = {}
        self.paused: list[Task] = []
        # when the next alarm rings, and the time between alarms; 0 for none
        self.alarm = self.interval = 0
        self._set = 0  # how often the alarm was set; if it was set again, the earlier alarm does not ring

    def handler(self, number: int) -> Any:
        """Return a signal's handler."""
        default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
        return self.handlers.get(number, default)

    def receive(self, number: int) -> None:
        """Call the handler in the running task, or do what the signal does by default.

        SIGINT and SIGTERM shut the node down, as rospy and rclpy do.
        """
        handler = self.handler(number)
        if callable(handler) and handler is not signal.default_int_handler:
            self._call(handler, number)
        elif handler == signal.SIG_IGN or number in _HARMLESS:
            return
        elif number in (signal.SIGINT, signal.SIGTERM):
            self.process.scheduler.later(self.process.end)
        else:
            raise ProcessExit(_BY_A_SIGNAL + number)

    def _call(self, handler: Callable[[int, Any], Any], number: int) -> None:
        """Call a handler, then wake the tasks in `pause`.

        As in Python, an exception of the handler goes to the main program. If another task called the handler, the
        exception is raised where the main program waits.
        """
        process = self.process
        try:
            handler(number, sys._getframe(2))
        except (GreenletExit, ProcessExit):
            raise
        except BaseException as error:
            if process.main in (None, running_task()):
                raise
            process.scheduler.later(partial(process.scheduler.interrupt, process.main, error))
            return
        for task in self.paused:
            process.scheduler.wake(task)

    def set_alarm(self, delay: int, interval: int = 0) -> tuple[int, int]:
        """Set the alarm, or remove it if `delay` is 0; return the rest of the previous alarm, and its interval."""
        scheduler = self.process.scheduler
        before = max(self.alarm - scheduler.time, 0) if self.alarm else 0, self.interval
        self._set += 1
        self.alarm, self.interval = scheduler.time + delay if delay else 0, interval if delay else 0
        if delay:
            scheduler.at(self.alarm, partial(self._ring, self._set))
        return before

    def _ring(self, which: int) -> None:
        if which != self._set or self.process.ending:
            return
        self.set_alarm(self.interval, self.interval)
        self.process.scheduler.spawn(self.process, self.receive, signal.SIGALRM)


@contextmanager
def signals_of_nodes() -> Iterator[None]:
    """Replace the functions that handle or send signals, or replace the process, while nodes run."""
    owner = os.getpid()

    def own() -> _Signals | None:
        process = running_process()
        return None if process is None or os.getpid() != owner else process.part(_Signals)

    with ExitStack() as undo:

        def replace(module: Any, name: str, virtual: Callable[..., Any]) -> None:
            real = getattr(module, name, None)
            if real is None:  # does not exist on this system
                return

            def choose(*args: Any, **named: Any) -> Any:
                signals = own()
                return real(*args, **named) if signals is None else virtual(signals, *args, **named)

            choose.__name__ = name
            setattr(module, name, choose)
            undo.callback(setattr, module, name, real)

        replace(signal, "signal", _signal)
        replace(signal, "getsignal", lambda signals, number: signals.handler(number))
        replace(signal, "alarm", _alarm)
        replace(signal, "setitimer", _setitimer)
        replace(signal, "getitimer", _getitimer)
        replace(signal, "pause", _pause)
        replace(signal, "raise_signal", lambda signals, number: signals.receive(number))
        # all threads of a node run in pytest's thread, so a signal to any thread goes to the node
        replace(
            signal, "pthread_kill", lambda signals, _, number: signals.receive(number) if number else None
        )
        replace(_thread, "interrupt_main", _interrupt_main)
        replace(os, "kill", partial(_kill, os.kill))
        replace(os, "killpg", partial(_killpg, os.killpg))
        replace(os, "abort", _abort)
        for name in ("execv", "execve"):
            replace(os, name, partial(_exec, name))
        yield


def _signal(signals: _Signals, number: int, handler: Any) -> Any:
    if number not in signal.valid_signals():
        raise ValueError("signal number out of range")
    if number in _UNCHANGEABLE:
        raise OSError(22, "Invalid argument")
    if not callable(handler) and handler not in (signal.SIG_IGN, signal.SIG_DFL):
        raise TypeError("signal handler must be signal.SIG_IGN, signal.SIG_DFL, or a callable object")
    before = signals.handler(number)
    signals.handlers[number] = handler
    return before


def _alarm(signals: _Signals, delay: int) -> int:
    return ceil(seconds(signals.set_alarm(nanoseconds(delay))[0]))


def _setitimer(signals: _Signals, which: int, delay: float, interval: float = 0.0) -> tuple[float, float]:
    if which != signal.ITIMER_REAL:
        raise UnsupportedApiError(
            "signal.setitimer: only ITIMER_REAL works in a node, since the other timers count the time of pytest."
        )
    left, period = signals.set_alarm(nanoseconds(delay), nanoseconds(interval))
    return seconds(left), seconds(period)


def _getitimer(signals: _Signals, which: int) -> tuple[float, float]:
    if which != signal.ITIMER_REAL or not signals.alarm:
        return 0.0, 0.0
    return seconds(signals.alarm - signals.process.scheduler.time), seconds(signals.interval)


def _pause(signals: _Signals) -> None:
    if signals.process.ending:
        signals.process.refuse_to_wait()
        return
    task = running_task()
    if task is not None:
        signals.paused.append(task)
        try:
            signals.process.scheduler.wait()
        finally:
            signals.paused.remove(task)


def _interrupt_main(signals: _Signals, number: int = signal.SIGINT) -> None:
    if signals.handler(number) not in (signal.SIG_IGN, signal.SIG_DFL):
        signals.receive(number)


def _kill(real: Callable[..., Any], signals: _Signals, pid: int, number: int) -> None:
    if number and pid in (0, os.getpid(), -os.getpgrp()):
        signals.receive(number)
    else:
        real(pid, number)


def _killpg(real: Callable[..., Any], signals: _Signals, group: int, number: int) -> None:
    if number and group in (0, os.getpgrp()):
        signals.receive(number)
    else:
        real(group, number)


def _abort(_: _Signals) -> NoReturn:
    raise ProcessExit(_BY_A_SIGNAL + signal.SIGABRT)


def _exec(name: str, _: _Signals, path: Any, *__: Any) -> NoReturn:
    raise UnsupportedApiError(
        f"os.{name} cannot replace a node by {os.fsdecode(path)!r}, since the node runs inside pytest. Start the other "
        "program in the test."
    )
