"""Display of paths, and atomic writing of files."""

from __future__ import annotations

import os
from pathlib import Path


def write_atomically(
    path: Path, content: bytes, *, parents: bool = False, through_links: bool = False
) -> None:
    """Write a file under another name and then rename it, so that readers never see a partial file.

    With `parents`, make the missing folders above it. A symbolic link is replaced by the file, so that a link in a
    project cannot lead the write out of it; with `through_links`, for a file that the user named, the link's target is
    written. An existing file keeps its mode. A device or pipe is written to directly. Raise OSError on failure.
    """
    target = Path(os.path.realpath(path)) if through_links else path
    if target.exists() and not target.is_file():
        target.write_bytes(content)
        return
    if parents:
        target.parent.mkdir(parents=True, exist_ok=True)
    descriptor, temporary = open_beside(target)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        if target.exists():
            temporary.chmod(target.stat().st_mode & 0o777)
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def open_beside(path: Path) -> tuple[int, Path]:
    """Create a hidden file with a random name in the folder of `path`. Return its descriptor and its path."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.{os.urandom(4).hex()}")
    return os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666), beside


def shown(path: Path) -> str:
    """Return a path for display: with slashes, relative to the working directory if below it."""
    try:
        return path.absolute().relative_to(Path.cwd()).as_posix()
    except ValueError:
        return path.absolute().as_posix()
