"""Protect the parts of the interpreter that a node may change and pytest still needs."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pytest_tarl.ros.scheduler import running_task


def _noted(change: Callable[..., None], before: list[Path]) -> Callable[..., None]:
    def choose(*args: Any, **named: Any) -> None:
        if running_task() is not None and not before:
            before.append(Path.cwd())
        change(*args, **named)

    return choose


@contextmanager
def _working_directory_kept() -> Iterator[None]:
    """Undo a node's changes of the working directory, so that all episodes start in the same one."""
    before: list[Path] = []
    real = {name: getattr(os, name) for name in ("chdir", "fchdir") if hasattr(os, name)}
    for name, change in real.items():
        setattr(os, name, _noted(change, before))
    try:
        yield
    finally:
        for name, change in real.items():
            setattr(os, name, change)
        if before:
            with suppress(OSError):  # the directory was removed
                os.chdir(before[0])


@contextmanager
def interpreter_kept() -> Iterator[None]:
    """Restore the recursion limit, the working directory, and the import paths and finders that nodes remove."""
    limit, paths, finders = sys.getrecursionlimit(), [*sys.path], [*sys.meta_path]
    try:
        with _working_directory_kept():
            yield
    finally:
        sys.setrecursionlimit(limit)
        sys.path.extend(one for one in paths if one not in sys.path)
        sys.meta_path.extend(one for one in finders if one not in sys.meta_path)
