"""Stop a node that never waits. The limit is CPU time, so that no node is stopped because the machine is busy."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress

from pytest_tarl.held_interpreter import allow

DEFAULT_LIMIT = 10.0  # CPU seconds without progress of virtual time
# a node that waits outside ROS, without using CPU time, is stopped after this many limits of real time
_PATIENCE = 12
_HOLD = 12  # a node that holds the interpreter lock is stopped after this many limits
_INTERVAL = 0.1  # seconds between two checks
_IDLE_EXIT = 50  # the watching thread ends after this many checks without use
# maximum rounds of a loop in which an exception that was sent is raised; one is enough
_MOST_JUMPS = 1000
_DEBUGGERS = ("pdb", "bdb", "pydevd", "debugpy")
_CLOCK_OF: Callable[[int], int] | None = getattr(
    time, "pthread_getcpuclockid", None
)  # does not exist on macOS and Windows
_read_clock: Callable[[int], float] | None = getattr(
    time, "clock_gettime", None
)  # the real clocks, saved before nodes get the virtual clock
_process_time = time.process_time


class Spinning(BaseException):
    """Raised in a node that never waits; a BaseException, so that `except Exception` does not catch it."""


class Watchdog:
    """Watches the thread that arms it. `arm`, `disarm` and `beat` only make a few assignments."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._armed = False
        self._moves = 0  # counter of progress; if it stays the same, there was none
        self._limit = DEFAULT_LIMIT
        self._target = 0
        self._clock = -1
        self._watching = False
        self._allowed = False  # whether the kernel's CPU timer is also running
        self.fired = False
        # whether the watchdog fired because of a wait outside ROS
        self.hung = False

    def arm(self, limit: float) -> None:
        """Watch the calling thread: fire after `limit` CPU seconds without `beat`."""
        thread = threading.get_ident()
        if thread != self._target:
            self._target = thread
            self._clock = -1 if _CLOCK_OF is None else _CLOCK_OF(thread)
        self._limit = limit
        self.fired = False
        self._moves += 1
        self._armed = True
        self._allow(limit * _HOLD)
        if not self._watching:
            self._watching = True
            threading.Thread(target=self._watch, name="tarl-watchdog", daemon=True).start()

    def beat(self) -> None:
        """Restart the limit, because virtual time has advanced."""
        self._moves += 1

    def disarm(self) -> bool:
        """Stop watching and return whether it fired; cancel an exception that has not been raised yet.

        Call this in the watched thread.
        """
        self._armed = False
        if self._allowed:
            self._allow(0.0)
        with self._lock:  # the watching thread may be about to fire
            if not self.fired:
                return False
            self.fired = False
            _cancel_in(self._target)
        return True

    def hanging(self, limit: float) -> str:
        """Describe the limit that was exceeded."""
        if self.hung:
            return f"{limit * _PATIENCE:g} s of waiting for something outside of ROS"
        return f"{limit:g} s of computing"

    def _watch(self) -> None:
        pause = threading.Event()
        seen, looks, computed, idle = -1, 0, 0.0, 0
        while True:
            pause.wait(_INTERVAL)
            idle = 0 if self._armed else idle + 1
            if idle > _IDLE_EXIT:
                self._watching = False
                # still not armed after the flag was cleared, so this thread may end
                if not self._armed:
                    return
                self._watching = True
            self._allow(self._limit * _HOLD if self._armed else 0.0)
            moves = self._moves
            if idle or moves != seen:
                seen, looks, computed = moves, 0, self._computed()
                continue
            # count checks, not time: there are no checks while the process is suspended
            looks += 1
            worked = self._computed() - computed >= self._limit
            if worked or (looks * _INTERVAL >= self._limit * _PATIENCE and not _debugged(self._target)):
                self._fire(moves, hung=not worked)
                seen = -1  # fire again later: a bare `except:` in the node may catch the exception

    def _allow(self, seconds: float) -> None:
        """Set or clear the kernel's CPU timer, which ends a process whose interpreter lock is held."""
        if seconds or self._allowed:
            self._allowed = bool(seconds)
            allow(seconds)
        if seconds and not self._armed:  # another thread has disarmed the watchdog since
            self._allow(0.0)

    def _computed(self) -> float:
        """Return the watched thread's CPU seconds, or the process's if there is no thread clock."""
        if self._clock != -1 and _read_clock is not None:
            try:
                return _read_clock(self._clock)
            except OSError:  # the thread has ended, and its id was reused
                self._target = 0
                return 0.0
        return _process_time()

    def forget(self) -> None:
        """Reset after a fork, which threads do not survive."""
        self.__init__()  # type: ignore[misc]

    def _fire(self, moves: int, *, hung: bool) -> None:
        with self._lock:
            if not self._armed or self._moves != moves:
                return
            self.fired, self.hung = True, hung
            _raise_in(self._target, Spinning)


def _debugged(thread: int) -> bool:
    """Return whether a thread is stopped in a debugger; this time does not count."""
    frame = sys._current_frames().get(thread)
    while frame is not None:
        if str(frame.f_globals.get("__name__", "")).startswith(_DEBUGGERS):
            return True
        frame = frame.f_back
    return False


def _cancel_in(thread: int) -> None:
    """Cancel an exception that was sent to the running thread and may not have been raised yet.

    Before Python 3.13, sending "no exception" leaves the interpreter's flag for a pending exception set. With Python
    3.11 and a trace function (such as that of coverage), the next function call would then never start. Only raising an
    exception resets the flag.
    """
    with suppress(Spinning):
        _raise_in(thread, Spinning)
        for _ in range(_MOST_JUMPS):
            pass


def _raise_in(thread: int, exception: type[BaseException]) -> None:
    import ctypes  # imported late because it is slow

    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(exception))


WATCHDOG = Watchdog()  # one watching thread per process
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=WATCHDOG.forget)
