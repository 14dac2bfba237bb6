"""Stop a node that never waits. Measured is what it computes: a busy machine stops nobody. No result depends on it."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable

from pytest_tarl.held_interpreter import allow

DEFAULT_LIMIT = 10.0  # seconds of computing in which virtual time stands still
_PATIENCE = 12  # how many times as long a node may hang in something that is neither computing nor ROS
_HOLD = 12  # the same in CPU time, for one that lets no thread look
_INTERVAL = 0.1  # seconds between two looks
_IDLE_EXIT = 50  # looks after which an unused watching thread ends
_DEBUGGERS = ("pdb", "bdb", "pydevd", "debugpy")
_CLOCK_OF: Callable[[int], int] | None = getattr(
    time, "pthread_getcpuclockid", None
)  # not on macOS and Windows
_read_clock: Callable[[int], float] | None = getattr(
    time, "clock_gettime", None
)  # bound before nodes see another
_process_time = time.process_time


class Spinning(BaseException):
    """Raised into a node that never waits. Not an Exception, so that `except Exception` lets it through."""


class Watchdog:
    """Watches the thread that arms it. Arming, disarming and progress cost a few assignments."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._armed = False
        self._moves = 0  # grows with all progress: what looks the same in two looks stood still
        self._limit = DEFAULT_LIMIT
        self._target = 0
        self._clock = -1
        self._watching = False
        self._allowed = False  # whether the system counts as well
        self.fired = False
        self.hung = False  # whether what fired was a wait for something outside, not computing

    def arm(self, limit: float) -> None:
        """Watch the calling thread from now on for `limit` seconds of its CPU time."""
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
        """Start the limit anew: virtual time moved."""
        self._moves += 1

    def disarm(self) -> bool:
        """Stop watching; tell whether it fired. Takes back an exception that has not arrived yet."""
        self._armed = False
        if self._allowed:
            self._allow(0.0)
        if not self.fired:
            return False
        with self._lock:
            _raise_in(self._target, None)
            self.fired = False
        return True

    def hanging(self, limit: float) -> str:
        """Say what went by before it fired."""
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
                if not self._armed:  # nobody armed it in between, trusting that we watch
                    return
                self._watching = True
            self._allow(self._limit * _HOLD if self._armed else 0.0)
            moves = self._moves
            if idle or moves != seen:
                seen, looks, computed = moves, 0, self._computed()
                continue
            looks += 1  # counted, not read from a clock: a process that is stopped does not look
            worked = self._computed() - computed >= self._limit
            if worked or (looks * _INTERVAL >= self._limit * _PATIENCE and not _debugged(self._target)):
                self._fire(moves, hung=not worked)
                seen = -1  # again later, should a bare `except:` swallow it

    def _allow(self, seconds: float) -> None:
        """Let the system end a process whose interpreter is held for so long, or no longer mind it."""
        if seconds or self._allowed:
            self._allowed = bool(seconds)
            allow(seconds)
        if seconds and not self._armed:  # disarmed in between
            self._allow(0.0)

    def _computed(self) -> float:
        """Return the CPU seconds of the watched thread, where there is no such clock those of the process."""
        if self._clock != -1 and _read_clock is not None:
            try:
                return _read_clock(self._clock)
            except OSError:  # that thread has ended, and another one has its number
                self._target = 0
                return 0.0
        return _process_time()

    def forget(self) -> None:
        """Start anew: threads do not survive a fork."""
        self.__init__()  # type: ignore[misc]

    def _fire(self, moves: int, *, hung: bool) -> None:
        with self._lock:
            if not self._armed or self._moves != moves:
                return
            self.fired, self.hung = True, hung
            _raise_in(self._target, Spinning)


def _debugged(thread: int) -> bool:
    """Tell whether a thread stands in a debugger, where somebody may take their time."""
    frame = sys._current_frames().get(thread)
    while frame is not None:
        if str(frame.f_globals.get("__name__", "")).startswith(_DEBUGGERS):
            return True
        frame = frame.f_back
    return False


def _raise_in(thread: int, exception: type[BaseException] | None) -> None:
    import ctypes  # slow to import and needed only here

    argument = ctypes.py_object(exception) if exception is not None else None
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), argument)


WATCHDOG = Watchdog()  # one watching thread per process
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=WATCHDOG.forget)
