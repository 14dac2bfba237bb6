"""Make a node's `os._exit` end only this node.

If a node forks, the child is a copy of pytest. It may compute and end as a program does. If it returned to the
scheduler, it would run the rest of the tests a second time, so it is ended at its first call that waits.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NoReturn

from greenlet import getcurrent, greenlet

from pytest_tarl.ros.scheduler import running_task

_WAITED = b"""tarl: a child process that a node forked waits in the in-process ROS, which serves only its parent. The
child was ended. Let it only compute and end, or start it as a program of its own with subprocess.
"""


class ProcessExit(SystemExit):
    """End a node's whole process, from any of its threads."""


@contextmanager
def exits_of_nodes() -> Iterator[None]:
    """Replace `os._exit` while nodes run, because it would end pytest."""
    real, owner, fork = os._exit, os.getpid(), getattr(os, "fork", None)

    def leave(status: int) -> NoReturn:
        if running_task() is not None and os.getpid() == owner:
            raise ProcessExit(status)
        real(status)

    os._exit = leave
    if fork is not None:
        os.fork = _fork(fork, real)
    try:
        yield
    finally:
        os._exit = real
        if fork is not None:
            os.fork = fork


def _fork(fork: Callable[[], int], leave: Callable[[int], Any]) -> Callable[[], int]:
    def waited(*_: object) -> None:
        os.write(2, _WAITED)
        leave(1)

    def failed(_: object, error: BaseException) -> None:
        status = _status(error)
        _flush()
        leave(status)

    def finished(_: object) -> None:
        _flush()
        leave(0)

    def forked() -> int:
        task = running_task()
        if task is not None:
            _flush()  # otherwise the child would write the buffered text a second time
        child = fork()
        if not child and task is not None:
            worker = getcurrent()
            worker.parent = greenlet(waited, worker.parent)
            vars(task.process).update(failed=failed, finished=finished)
        return child

    return forked


def _status(error: BaseException) -> int:
    """Return the exit status of a program that ends with an exception; print what Python would print."""
    if not isinstance(error, SystemExit):
        traceback.print_exception(error)
        return 1
    if isinstance(error.code, int):
        return error.code
    if error.code is not None:
        print(error.code, file=sys.stderr)
    return int(error.code is not None)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # None, a full disk, or closed
            stream.flush()
