"""End a node that holds the interpreter in a C loop, where no Python thread runs any more.

A timer counts the CPU time of the process and is re-armed as long as Python threads run. When it expires,
faulthandler writes the stack of every thread to pytest's original standard error, and SIGVTALRM ends the process.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress

SIGNAL: int | None = getattr(signal, "SIGVTALRM", None)  # not on Windows
_stderr: int | None = None
_registered = False


def prepare() -> None:
    """Save the process's standard error before pytest captures it."""
    global _stderr
    if _stderr is None:
        with suppress(OSError):  # no standard error, as under pythonw
            _stderr = os.dup(2)


def allow(seconds: float) -> None:
    """Limit the CPU time of the process from now on, in seconds; 0 for no limit."""
    if SIGNAL is not None and (_registered or (seconds and _register())):
        signal.setitimer(signal.ITIMER_VIRTUAL, seconds)


def _register() -> bool:
    """Make the signal dump all stacks and end the process; return False if another handler uses it."""
    global _registered
    if SIGNAL is None or signal.getsignal(SIGNAL) != signal.SIG_DFL:
        return False
    import faulthandler

    prepare()
    if _stderr is not None:
        faulthandler.register(SIGNAL, file=_stderr, all_threads=True, chain=True)
        _registered = True
    return _registered
