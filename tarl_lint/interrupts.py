"""Ctrl-C in a terminal reaches every process: one of them says so, the others end without a word."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let Ctrl-C wait, also for the processes that are started meanwhile, until they say `end_silently`."""
    import signal  # only runs with several processes need it

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
    """Let Ctrl-C end this process without a traceback."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def over() -> None:
    """Let no second Ctrl-C disturb the end of this process."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
