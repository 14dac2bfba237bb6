"""Make `os._exit` of a node end only this node.

A forked child of a node is a copy of pytest. It may compute and end, but if it came back to the scheduler, it would run
the rest of the tests a second time. It is therefore ended at the first call of the ROS API that waits.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

from greenlet import getcurrent, greenlet

from pytest_tarl.ros.scheduler import running_task

_RETURNED = b"""tarl: a child process that a node forked waits or ends in the in-process ROS, which serves only its
parent. The child was ended. Let it end with os._exit, or start it as a program of its own with subprocess.
"""


class ProcessExit(SystemExit):
    """Raised to end the whole process of a node, from any of its threads."""


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
    def returned(*_: object) -> None:
        os.write(2, _RETURNED)
        leave(1)

    def forked() -> int:
        child = fork()
        if not child and running_task() is not None:
            task = getcurrent()
            task.parent = greenlet(returned, task.parent)
        return child

    return forked
