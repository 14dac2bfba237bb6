"""Worker processes. None of them can import what is linted, and Ctrl-C ends them without a word.

Workers are forked where the system can: a copy of this process has its modules and its `sys.path`, so it looks nothing
up. A spawned worker starts with the working directory on its path, before any of our code runs; Windows, which knows
no other way, is told not to (`PYTHONSAFEPATH`, Python 3.11). Forking is safe only while there is one thread; where a
program that calls us has more, there are no workers.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

from tarl_lint.interrupts import end_silently, uninterrupted
from tarl_lint.progress import Tell, paused

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing.context import BaseContext

Work = TypeVar("Work")
Answer = TypeVar("Answer")


def in_processes(
    perform: Callable[[Work], Answer], work: Sequence[Work], sizes: Sequence[int], workers: int, tell: Tell
) -> list[Answer] | None:
    """Return the answers in the order of the work, or None where no process can be started safely.

    The largest come first, so that nobody waits for a large one that came last.
    """
    order = sorted(range(len(work)), key=lambda number: -sizes[number])
    with paused(tell):
        pool = _pool(workers)
        if pool is None:
            return None
        with uninterrupted(), _safe_path():
            chunk = 1 + len(work) // (workers * 16)
            done = pool.map(perform, [work[number] for number in order], chunksize=chunk)
    with pool:
        try:
            answers = dict(zip(order, done, strict=True))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [answers[number] for number in range(len(work))]


def _pool(workers: int) -> ProcessPoolExecutor | None:
    from concurrent.futures import ProcessPoolExecutor

    context = _context()
    if context is None:
        return None
    try:
        return ProcessPoolExecutor(workers, context, end_silently)
    except (ImportError, NotImplementedError, OSError):  # the system has no semaphores
        return None


def _context() -> BaseContext | None:
    import multiprocessing
    import threading

    if "fork" in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("fork") if threading.active_count() == 1 else None
    return multiprocessing.get_context("spawn") if sys.version_info >= (3, 11) else None


@contextmanager
def _safe_path() -> Iterator[None]:
    """Have Python processes that are started meanwhile leave the working directory off their path."""
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before
