"""Read regular files, check in advance that files can be written, and explain why they cannot."""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from tarl_lint.files import open_beside

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))  # Windows has no EDQUOT
# bytes written to check whether a disk is full; most file systems allocate at least this much
BLOCK = 4096
DIFFERENT = (errno.EROFS, errno.EACCES, errno.EPERM)


def advice_on(problem: OSError) -> str:
    """Return advice for the user about a file that cannot be written."""
    if problem.errno in FULL:
        return "the disk or your quota is full: free some space and run the command again."
    if problem.errno == errno.EFBIG:
        return (
            "the file is larger than its limit: raise the limit, for example with `ulimit -f unlimited`, and run the "
            "command again."
        )
    if problem.errno in DIFFERENT:
        return "make the folder writable, or work in a copy."
    return (
        "something other than a regular file is at this path, or the disk fails: check the path and run the command "
        "again."
    )


def unwritten(failed: Mapping[Path, OSError], root: Path) -> list[str]:
    """Return one sentence, ending with advice, for each reason why files below `root` were not written."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for path, problem in failed.items():
        shown = path.relative_to(root).as_posix()
        reasons.setdefault((problem.strerror or str(problem), advice_on(problem)), []).append(shown)
    return [f"not written: {', '.join(paths)} ({why}): {advice}" for (why, advice), paths in reasons.items()]


def check_writable(path: Path) -> None:
    """Raise OSError if a file cannot be written. Remove everything that the check creates."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    made = [folder for folder in path.parents if not folder.exists()]  # innermost first
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, beside = open_beside(path)
        try:
            # most file systems can create an empty file even if the disk or the quota is full
            with os.fdopen(handle, "wb") as file:
                file.write(bytes(BLOCK))
        finally:
            beside.unlink()
    finally:
        for folder in made:
            with suppress(OSError):  # the folder was not created, or another run is using it
                folder.rmdir()


def existing(folder: Path, name: str | os.PathLike[str]) -> Path | None:
    """Return the resolved path of a file or folder that a test names, or None if it does not exist.

    Return None also for a loop of links, and for an impossible name: one that contains a NUL or a lone surrogate, or is
    too long.
    """
    try:
        path = (folder / name).resolve(strict=True)
    except (OSError, ValueError, RuntimeError):
        return None
    return path


def slug(text: str) -> str:
    """Return a string as part of a valid file name."""
    return re.sub(r"[^A-Za-z0-9]+", "-", text.replace(".py", "")).strip("-")[:60]


def read_regular(path: Path) -> bytes:
    """Return the content of a regular file. Raise OSError for other files, such as named pipes or devices.

    Reading other files could block or never end.
    """
    # without O_NONBLOCK, open() on a pipe waits for a writer; Windows has neither the flag nor such pipes
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        kind = os.fstat(handle).st_mode
        if stat.S_ISDIR(kind):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(kind):
            raise OSError(errno.EINVAL, "it is not a regular file", str(path))
        with open(handle, "rb", closefd=False) as file:
            return file.read()
    finally:
        os.close(handle)
