"""End the process if a node holds the interpreter lock in a C loop, so that no Python thread can run.

A timer measures the CPU time of the process, and Python code restarts it regularly. When it expires, faulthandler
writes the stacks of all threads to pytest's original standard error, and SIGVTALRM ends the process.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress

SIGNAL: int | None = getattr(signal, "SIGVTALRM", None)  # does not exist on Windows
_stderr: int | None = None
_registered = False


def prepare() -> None:
    """Duplicate the descriptor of standard error before pytest captures it."""
    global _stderr
    if _stderr is None:
        with suppress(OSError):  # no standard error, for example under pythonw
            _stderr = os.dup(2)


def allow(seconds: float) -> None:
    """Allow the process this many seconds of CPU time from now on; 0 means no limit."""
    if SIGNAL is not None and (_registered or (seconds and _register())):
        signal.setitimer(signal.ITIMER_VIRTUAL, seconds)


def _register() -> bool:
    """Make the signal dump all stacks and end the process; return False if it has another handler."""
    global _registered
    if SIGNAL is None or signal.getsignal(SIGNAL) != signal.SIG_DFL:
        return False
    import faulthandler

    prepare()
    if _stderr is not None:
        faulthandler.register(SIGNAL, file=_stderr, all_threads=True, chain=True)
        _registered = True
    return _registered
