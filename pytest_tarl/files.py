"""Files that are there whole or not at all."""

from __future__ import annotations

import errno
import os
import re
import tempfile
from contextlib import suppress
from pathlib import Path

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))  # Windows has no quota error
DIFFERENT = (errno.EROFS, errno.EACCES, errno.EPERM)


def advice_on(problem: OSError) -> str:
    """Return what to do where a file cannot be written."""
    if problem.errno in FULL:
        return "the disk is full, or your quota of it: free some space and run it again."
    if problem.errno in DIFFERENT:
        return "give yourself the right to write there, or run in a copy."
    return "something else is in its place, or the disk fails: look there and run it again."


def check_writable(path: Path) -> None:
    """Find out whether a file can be written later, and leave nothing behind. Raises OSError where it cannot."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    made = [folder for folder in path.parents if not folder.exists()]  # the innermost first
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        os.close(handle)
        Path(name).unlink()
    finally:
        for folder in made:
            with suppress(OSError):  # another run has put something there, or the folder was never made
                folder.rmdir()


def slug(text: str) -> str:
    """Return a text as part of a file name."""
    return re.sub(r"[^A-Za-z0-9]+", "-", text.replace(".py", "")).strip("-")[:60]


def write_atomically(path: Path, content: bytes) -> None:
    """Write to a temporary file beside `path` and rename it, making folders as needed. Raises OSError.

    What is no file, as a device or a pipe, is written to and never replaced.
    """
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
