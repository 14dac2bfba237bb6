"""Paths as `pathlib` and `os.path` compute them, without access to files."""

from __future__ import annotations

import posixpath
from pathlib import PurePosixPath
from typing import Any, ClassVar

from tarl_lint.workspace.python.values import Unknown


class FilePath(PurePosixPath):
    """A `pathlib.Path` without access to files."""

    readable: ClassVar = frozenset({
        "parent", "parents", "name", "stem", "suffix", "suffixes", "parts", "joinpath", "as_posix", "with_name",
        "with_stem", "with_suffix", "is_absolute", "relative_to", "is_relative_to", "resolve", "absolute",
        "expanduser", "match", "anchor", "root", "drive", "as_uri", "with_segments",
    })  # fmt: skip

    def __repr__(self) -> str:
        return f"PosixPath({str(self)!r})"

    def resolve(self, *_: Any, **__: Any) -> FilePath | Unknown:
        """Return the path without `..`; Unknown if it is relative."""
        return FilePath(normal(str(self))) if self.is_absolute() else Unknown(0, str(self))

    def absolute(self) -> FilePath | Unknown:
        """Return the path; Unknown if it is relative."""
        return self if self.is_absolute() else Unknown(0, str(self))

    def expanduser(self) -> FilePath | Unknown:
        """Return the path; Unknown if it begins with a user's home."""
        return Unknown(0, str(self)) if str(self).startswith("~") else self


def normal(path: str) -> str:
    """Return a path without `..` and double slashes."""
    return posixpath.normpath(path)


def absolute(path: Any) -> Any:
    """Return `os.path.abspath`; Unknown for a relative path."""
    text = str(path)
    return normal(text) if text.startswith("/") else Unknown(0, text)


def relative(path: Any, start: Any = None) -> Any:
    """Return `os.path.relpath`; Unknown if it depends on the working directory."""
    one, other = str(path), "" if start is None else str(start)
    if one.startswith("/") and other.startswith("/"):
        return posixpath.relpath(one, other)
    return Unknown(0, f"relpath({one})")


def with_user(path: Any) -> Any:
    """Return `os.path.expanduser`; Unknown if the path begins with a user's home."""
    return Unknown(0, str(path)) if str(path).startswith("~") else path


def with_variables(path: Any) -> Any:
    """Return `os.path.expandvars`; Unknown if the path contains a variable."""
    return Unknown(0, str(path)) if "$" in str(path) else path


OF_PATHS = {
    "os.path.join": posixpath.join, "os.path.basename": posixpath.basename, "os.path.dirname": posixpath.dirname,
    "os.path.split": posixpath.split, "os.path.splitext": posixpath.splitext, "os.path.normpath": normal,
    "os.path.normcase": posixpath.normcase, "os.path.isabs": posixpath.isabs, "os.path.relpath": relative,
    "os.path.commonprefix": lambda paths: posixpath.commonprefix(list(paths)),
    "os.path.commonpath": lambda paths: posixpath.commonpath(list(paths)),
    "os.path.realpath": absolute, "os.path.abspath": absolute, "os.path.expanduser": with_user,
    "os.path.expandvars": with_variables, "os.fspath": str, "os.fsdecode": str,
}  # fmt: skip
