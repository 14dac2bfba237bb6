"""A lock that a process and its children hold until each of them has ended, so that tests need no process ids."""

from __future__ import annotations

import fcntl
import time
from pathlib import Path

# What a program runs to hold the lock; `lock` stays open in its children, if they are passed `lock.fileno()`
HOLD = "import fcntl, os; lock = open(os.environ['HELD'], 'w'); fcntl.flock(lock, fcntl.LOCK_EX)\n"
LONGEST = 60.0  # s; long enough for a busy machine


def held(path: Path) -> bool:
    """Return whether a process holds the lock at this moment."""
    with path.open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


def comes_free(path: Path) -> bool:
    """Wait for the end of all processes that hold the lock; return False if one of them does not end."""
    deadline = time.monotonic() + LONGEST
    while held(path):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True
