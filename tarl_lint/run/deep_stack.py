"""A stack for deep recursion: the analysis recurses as deeply as the analysed programs nest calls and expressions.

CPython keeps frames in chunks of 16 KB. CPython maps a new chunk when a call does not fit into the current one, and
unmaps the chunk when that call returns. Code whose calls repeatedly cross the end of a chunk spends up to a third
of its time on these system calls. A frame that is larger than a chunk gets a chunk of its own, whose size is
rounded up to a power of two. If a function needs slightly more than half of a large chunk, the rest of the chunk is
therefore available to the functions that it calls.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Final, TypeVar

MAX_RECURSION: Final = 5_000
HALF_A_CHUNK: Final = 2**18  # size of the stack in words; unused pages of the stack take no memory

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


# Python before 3.11 has no common stack of frames, so no room has to be made
if sys.version_info >= (3, 11):
    _with_room.__code__ = _with_room.__code__.replace(co_stacksize=HALF_A_CHUNK)
