"""Ctrl-C in a terminal reaches every process. The main process prints a message; the others end silently."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Block Ctrl-C in this process; processes started meanwhile block it until they call `end_silently`."""
    import signal  # imported here because only runs with several processes need this module

    mask = getattr(signal, "pthread_sigmask", None)
    if mask is None:  # Windows
        yield
        return
    before = mask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        mask(signal.SIG_SETMASK, before)


def end_silently() -> None:
    """Let Ctrl-C end this process without a traceback. This changes nothing if the process ignores Ctrl-C."""
    import signal

    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def over() -> None:
    """Ignore a second Ctrl-C while this process ends."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
