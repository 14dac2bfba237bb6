"""Replace several files or none, without following links."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

RELATIVE = {os.open, os.rename, os.unlink, os.link} <= os.supports_dir_fd  # not on Windows
_NOFOLLOW: int = getattr(os, "O_NOFOLLOW", 0)
_READ: int = os.O_RDONLY | _NOFOLLOW | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
_FOLDER: int = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | _NOFOLLOW
_CREATE: int = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _NOFOLLOW | getattr(os, "O_BINARY", 0)


class MovedError(Exception):
    """A file changed after it was checked."""

    def __init__(self, path: Path) -> None:
        super().__init__(str(path))
        self.path = path


@dataclass(frozen=True)
class Change:
    """A file in `project` to be changed from `before` to `after`."""

    path: Path
    project: Path
    before: bytes
    after: bytes


@dataclass(frozen=True)
class _Opened:
    """A change whose folder is kept open, so that it cannot be replaced."""

    change: Change
    folder: int | None

    def name(self, suffix: str = "") -> str:
        """Return the file's name, or that of a temporary file beside it."""
        name = f".{self.change.path.name}.{suffix}" if suffix else self.change.path.name
        return name if self.folder is not None else str(self.change.path.with_name(name))


def replace_all(changes: Sequence[Change]) -> None:
    """Make all changes or none. Raise MovedError or OSError."""
    with ExitStack() as stack:
        opened = [stack.enter_context(_held(change)) for change in changes]
        suffix = secrets.token_hex(4)
        replaced: list[_Opened] = []
        try:
            for one in opened:
                _stage(one, f"{suffix}.new", f"{suffix}.old")
            for one in opened:
                replaced.append(one)
                _rename(one, f"{suffix}.new")
        except BaseException:
            for one in replaced:
                _rename(one, f"{suffix}.old")
            raise
        finally:
            for one in opened:
                for each in ("new", "old"):
                    with suppress(OSError):
                        os.unlink(one.name(f"{suffix}.{each}"), dir_fd=one.folder)


@contextmanager
def _held(change: Change) -> Iterator[_Opened]:
    """Open a file's folder. Raise OSError if the path contains a symbolic link."""
    if not RELATIVE:
        if change.path.resolve() != change.path:
            raise MovedError(change.path)
        yield _Opened(change, None)
        return
    handle = os.open(change.project, _FOLDER)
    try:
        for part in change.path.parent.relative_to(change.project).parts:
            try:
                inner = os.open(part, _FOLDER, dir_fd=handle)
            except OSError as problem:
                if problem.errno in (errno.ENOTDIR, errno.ELOOP, errno.ENOENT):
                    raise MovedError(change.path) from problem
                raise
            os.close(handle)
            handle = inner
        yield _Opened(change, handle)
    finally:
        os.close(handle)


def _stage(one: _Opened, new: str, old: str) -> None:
    """Write the new content beside the file, and keep the old content."""
    try:
        with os.fdopen(os.open(one.name(), _READ, dir_fd=one.folder), "rb") as file:
            status = os.fstat(file.fileno())
            content = file.read() if stat.S_ISREG(status.st_mode) else None
    except FileNotFoundError as problem:
        raise MovedError(one.change.path) from problem
    except OSError as problem:
        if one.folder is not None and stat.S_ISLNK(os.lstat(one.name(), dir_fd=one.folder).st_mode):
            raise MovedError(one.change.path) from problem
        raise
    if content != one.change.before:
        raise MovedError(one.change.path)
    _create(one, new, one.change.after, status)
    try:
        os.link(
            one.name(), one.name(old), src_dir_fd=one.folder, dst_dir_fd=one.folder, follow_symlinks=False
        )
    except (OSError, NotImplementedError):
        _create(one, old, one.change.before, status)


def _create(one: _Opened, suffix: str, content: bytes, status: os.stat_result) -> None:
    handle = os.open(one.name(suffix), _CREATE, 0o600, dir_fd=one.folder)
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        if hasattr(os, "fchmod"):
            with suppress(PermissionError):
                os.fchown(handle, status.st_uid, status.st_gid)
            os.fchmod(handle, stat.S_IMODE(status.st_mode))
        os.fsync(handle)


def _rename(one: _Opened, suffix: str) -> None:
    os.replace(one.name(suffix), one.name(), src_dir_fd=one.folder, dst_dir_fd=one.folder)
