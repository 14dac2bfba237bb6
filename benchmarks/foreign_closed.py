"""Restrict a process that runs untrusted code: no programs, no network, and no files outside a folder."""

from __future__ import annotations

import contextlib
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

_REFUSED = frozenset({"os.system", "subprocess.Popen", "os.exec", "os.posix_spawn", "os.spawn", "os.fork",
                      "os.forkpty", "os.kill", "os.killpg", "pty.spawn", "socket.connect", "socket.bind",
                      "socket.sendto", "socket.getaddrinfo", "os.putenv_system", "webbrowser.open"})  # fmt: skip
_CHANGING = {
    "os.remove": 0,
    "os.rmdir": 0,
    "os.mkdir": 0,
    "shutil.rmtree": 0,
    "os.truncate": 0,
    "os.chmod": 0,
    "os.chown": 0,
    "os.rename": 1,
    "os.symlink": 1,
    "os.link": 1,
    "shutil.copyfile": 1,
    "shutil.move": 1,
}
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def warm_up() -> None:
    """Import the modules that every test needs, so that forked processes do not have to."""
    import numpy  # noqa: F401
    import pytest  # noqa: F401

    import pytest_tarl.episode
    import pytest_tarl.instrumentation.recorder  # noqa: F401
    from pytest_tarl.ros import message_type

    message_type("std_msgs/msg/String"), message_type("std_msgs/String")
    os.environ["MPLBACKEND"] = "Agg"
    for library in ("cv2", "matplotlib.pyplot", "scipy", "yaml"):
        with contextlib.suppress(ImportError):
            import_module(library)


def close_all_but(folder: Path) -> None:
    """From now on, raise PermissionError for every operation that has effects outside a folder."""
    inside = (str(folder.resolve()) + os.sep, os.devnull)
    standard = {0, 1, 2}

    def may_write(path: Any) -> bool:
        if isinstance(path, int):
            return path in standard or path > 2
        return os.path.realpath(os.fsdecode(path)).startswith(inside)

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event in _REFUSED:
            if event == "os.kill" and arguments[:2] == (os.getpid(), 0):
                return
            raise PermissionError(f"closed here: {event}")
        if event == "open":
            path, mode, flags = arguments
            writes = (
                any(letter in mode for letter in "wax+") if isinstance(mode, str) else bool(flags & _WRITING)
            )
            if writes and not may_write(path):
                raise PermissionError(f"closed here: open {path}")
        elif event in _CHANGING and not may_write(arguments[_CHANGING[event]]):
            raise PermissionError(f"closed here: {event}")

    sys.addaudithook(hook)
