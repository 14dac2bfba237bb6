"""Keep what a node may change in the interpreter, and what pytest needs after the episode."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from pytest_tarl.ros.scheduler import running_task


def _for_others(close: Callable[[], None]) -> Callable[[], None]:
    def choose() -> None:
        if running_task() is None:
            close()

    return choose


@contextmanager
def interpreter_kept() -> Iterator[None]:
    """Let a node's `close()` of a standard stream do nothing; restore the recursion limit and removed import paths."""
    limit, paths, finders = sys.getrecursionlimit(), [*sys.path], [*sys.meta_path]
    kept = []
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError):  # None, or a stream without settable attributes
            stream.close = _for_others(stream.close)  # type: ignore[method-assign]
            kept.append(stream)
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)
        sys.path.extend(one for one in paths if one not in sys.path)
        sys.meta_path.extend(one for one in finders if one not in sys.meta_path)
        for stream in kept:
            with suppress(AttributeError):
                del stream.close
