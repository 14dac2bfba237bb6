"""Worker processes. A worker cannot import linted files, and Ctrl-C ends it silently.

Workers are forked if possible: a fork already has the modules and the `sys.path` of this process, so it does not
import anything again. A spawned worker has the working directory on its import path before any code of tarl-lint
runs. On Windows, which cannot fork, `PYTHONSAFEPATH` prevents this (Python 3.11). Forking is safe only with a
single thread; if the calling program has more, no workers are used.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

from tarl_lint.run.interrupts import end_silently, uninterrupted
from tarl_lint.run.progress import Tell, paused

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing.context import BaseContext

Work = TypeVar("Work")
Answer = TypeVar("Answer")
MOMENT = 1.0  # maximum time to wait for the management thread of an ended pool (s)


def in_processes(
    perform: Callable[[Work], Answer], work: Sequence[Work], sizes: Sequence[int], workers: int, tell: Tell
) -> list[Answer] | None:
    """Return the answers in the order of the work; None if processes cannot be started safely.

    The largest tasks start first, so that no large task runs alone at the end.
    """
    order = sorted(range(len(work)), key=lambda number: -sizes[number])
    with paused(tell):
        pool = _pool(workers)
        if pool is None:
            return None
        with _ending(pool), uninterrupted(), _safe_path():
            chunk = 1 + len(work) // (workers * 16)
            done = pool.map(perform, [work[number] for number in order], chunksize=chunk)
    with pool, _ending(pool):
        answers = dict(zip(order, done, strict=True))
    return [answers[number] for number in range(len(work))]


def _pool(workers: int) -> ProcessPoolExecutor | None:
    from concurrent.futures import ProcessPoolExecutor

    context = _context()
    if context is None:
        return None
    try:
        return ProcessPoolExecutor(workers, context, end_silently)
    except (ImportError, NotImplementedError, OSError):  # raised if the system has no semaphores
        return None


@contextmanager
def _ending(pool: ProcessPoolExecutor) -> Iterator[None]:
    """End a pool after an error or Ctrl-C."""
    try:
        yield
    except BaseException:
        _end(pool)
        raise


def _end(pool: ProcessPoolExecutor) -> None:
    """End a pool and its processes without waiting for tasks, and give its own thread a moment to end.

    A process that did not receive the Ctrl-C would continue its task, and the interpreter would wait for this
    process. If the thread closes its pipe while the interpreter ends, Python 3.11 writes to the closed pipe and
    prints a traceback. The thread ends at once unless a task is still running.
    """
    thread = getattr(pool, "_executor_manager_thread", None)
    processes = dict(getattr(pool, "_processes", None) or {})
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes.values():
        process.terminate()
    if thread is not None:
        thread.join(MOMENT)


def _context() -> BaseContext | None:
    import multiprocessing
    import threading

    if "fork" in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("fork") if threading.active_count() == 1 else None
    return multiprocessing.get_context("spawn") if sys.version_info >= (3, 11) else None


@contextmanager
def _safe_path() -> Iterator[None]:
    """Let Python processes that are started meanwhile omit the working directory from their import path."""
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before
