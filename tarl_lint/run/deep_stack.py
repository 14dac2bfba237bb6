"""A stack for deep recursion: the analysis recurses as deeply as calls and expressions in the analysed programs.

CPython keeps frames in chunks of 16 KB, which it maps when a call crosses their end and unmaps when that call returns;
code that moves up and down across a chunk's end spends up to a third of its time in the system. The size of a chunk
is that of the frame that needs it, rounded up to a power of two: a function that needs slightly more than half of a
large chunk leaves the rest to its callees.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Final, TypeVar

MAX_RECURSION: Final = 5_000
HALF_A_CHUNK: Final = 2**18  # words; untouched pages take no memory

Result = TypeVar("Result")


def with_deep_stack(work: Callable[[], Result]) -> Result:
    """Call a function that may recurse deeply and return its result."""
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
