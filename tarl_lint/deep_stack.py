"""A stack for deep recursion: calls of ours nest as deep as calls and expressions of the programs that are read.

CPython keeps frames in chunks of 16 KB, which it maps when a call crosses their end and unmaps when that call returns;
an interpreter that goes up and down there spends up to a third of its time in the system. The size of a chunk is that
of the frame that needs it, rounded up to a power of two: a function that asks for a little more than half of a large
chunk leaves the rest to all that it calls.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Final, TypeVar

MAX_RECURSION: Final = 5_000
HALF_A_CHUNK: Final = 2**18  # words; what is not used is never touched, so it takes no memory

Result = TypeVar("Result")


def with_deep_stack(work: Callable[[], Result]) -> Result:
    """Return what a function returns that may recurse deeply."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, MAX_RECURSION))
    try:
        return _with_room(work)
    finally:
        sys.setrecursionlimit(before)


def _with_room(work: Callable[[], Result]) -> Result:
    return work()


if sys.version_info >= (3, 11):  # before, each frame was an object of its own
    _with_room.__code__ = _with_room.__code__.replace(co_stacksize=HALF_A_CHUNK)
