"""Stop a node that never waits. Looks at wall time only for this; no result depends on it."""

from __future__ import annotations

import os
import threading
from time import monotonic  # bound now: nodes may see a virtual clock under `time.monotonic`

DEFAULT_LIMIT = 10.0  # seconds of wall time in which virtual time stands still
_INTERVAL = 0.1  # seconds between two looks
_IDLE_EXIT = 5.0  # seconds after which an unused watching thread ends


class Spinning(BaseException):
    """Raised into a node that never waits. Not an Exception, so that `except Exception` lets it through."""


class Watchdog:
    """Watches the thread that arms it. Arming and disarming cost two assignments."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._deadline: float | None = None
        self._limit = DEFAULT_LIMIT
        self._target = 0
        self._watching = False
        self.fired = False

    def arm(self, limit: float) -> None:
        """Watch the calling thread from now on for `limit` seconds of wall time."""
        self._target = threading.get_ident()
        self._limit = limit
        self.fired = False
        self._deadline = monotonic() + limit
        if not self._watching:
            self._watching = True
            threading.Thread(target=self._watch, name="tarl-watchdog", daemon=True).start()

    def beat(self) -> None:
        """Start the limit anew: virtual time moved."""
        self._deadline = monotonic() + self._limit

    def disarm(self) -> bool:
        """Stop watching; tell whether it fired. Takes back an exception that has not arrived yet."""
        self._deadline = None
        if not self.fired:
            return False
        with self._lock:
            _raise_in(self._target, None)
            self.fired = False
        return True

    def _watch(self) -> None:
        pause = threading.Event()
        idle_since = monotonic()
        while True:
            deadline = self._deadline
            if deadline is not None:
                idle_since = monotonic()
                if deadline <= idle_since:
                    self._fire()
            elif monotonic() - idle_since > _IDLE_EXIT:
                self._watching = False
                if self._deadline is None:  # nobody armed it in between, trusting that we watch
                    return
                self._watching = True
            pause.wait(_INTERVAL)

    def forget(self) -> None:
        """Start anew: threads do not survive a fork."""
        self.__init__()  # type: ignore[misc]

    def _fire(self) -> None:
        with self._lock:
            if self._deadline is None or self._deadline > monotonic():
                return
            self._deadline = monotonic() + self._limit  # again later, should a bare `except:` swallow it
            self.fired = True
            _raise_in(self._target, Spinning)


def _raise_in(thread: int, exception: type[BaseException] | None) -> None:
    import ctypes  # slow to import and needed only here

    argument = ctypes.py_object(exception) if exception is not None else None
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), argument)


WATCHDOG = Watchdog()  # one watching thread per process
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=WATCHDOG.forget)
