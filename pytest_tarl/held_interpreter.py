"""A node that holds the interpreter, in a loop of C: no thread of Python runs any more, so the system ends it.

Its timer counts CPU time of the process and is set anew as long as threads run. When it rings, faulthandler writes
where every thread stands, to the standard error that pytest was started with, and the process ends by SIGVTALRM.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress

SIGNAL: int | None = getattr(signal, "SIGVTALRM", None)  # not on Windows
_stderr: int | None = None
_registered = False


def prepare() -> None:
    """Keep the standard error of the process, before pytest captures it."""
    global _stderr
    if _stderr is None:
        with suppress(OSError):  # there is none, as under pythonw
            _stderr = os.dup(2)


def allow(seconds: float) -> None:
    """Let the process compute for so long from now on; 0 for as long as it likes."""
    if SIGNAL is not None and (_registered or (seconds and _register())):
        signal.setitimer(signal.ITIMER_VIRTUAL, seconds)


def _register() -> bool:
    """Have the signal tell and end; tell whether nobody else has a use for it."""
    global _registered
    if SIGNAL is None or signal.getsignal(SIGNAL) != signal.SIG_DFL:
        return False
    import faulthandler

    prepare()
    if _stderr is not None:
        faulthandler.register(SIGNAL, file=_stderr, all_threads=True, chain=True)
        _registered = True
    return _registered
