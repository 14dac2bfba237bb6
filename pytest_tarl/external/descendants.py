"""Manage the children, orphans and parent of this process on Linux."""

from __future__ import annotations

import ctypes
import os
import select
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG
_ADOPT = 36  # PR_SET_CHILD_SUBREAPER
_LINUX = sys.platform.startswith("linux")
_IGNORED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def outlive_the_test() -> None:
    """Ignore the signals that end the test, because this process must outlive it."""
    for number in _IGNORED:
        signal.signal(number, signal.SIG_IGN)


def adopt() -> None:
    """Become the parent of every descendant whose own parent ends."""
    if _LINUX:
        ctypes.CDLL(None).prctl(_ADOPT, 1, 0, 0, 0)


def adopted() -> list[int]:
    """Return the running children of this process, sorted by id."""
    if not _LINUX:
        return []
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # the process has just ended
            state, parent = path.read_text(errors="replace").rpartition(")")[2].split()[:2]
            if int(parent) == os.getpid() and state not in "ZX":
                found.append(int(path.parent.name))
    return sorted(found)


def reap(which: int) -> None:
    """Collect exit statuses: of all children for -1, of the group n for -n."""
    with suppress(ChildProcessError):
        while os.waitpid(which, os.WNOHANG)[0]:
            pass


def die_with_parent() -> Callable[[], None]:
    """Return a function for a new child to call before exec.

    The function restores default signals, and makes the kernel kill the child when this process ends.

    The C library is loaded before the fork. If another thread held the loader's lock during the fork, the child would
    otherwise wait for it forever.
    """
    prctl = ctypes.CDLL(None).prctl if _LINUX else None
    parent = os.getpid()

    def prepare() -> None:
        for number in _IGNORED:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        if prctl is not None:
            prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:  # the parent ended before prctl took effect
            os._exit(1)

    return prepare


def wait_for_end_of_parent() -> None:
    """Wait until this process's parent ends. Raise OSError if the system does not support this."""
    if sys.platform != "linux":
        raise OSError
    parent = os.pidfd_open(os.getppid())
    try:
        select.select([parent], [], [])
    finally:
        os.close(parent)
