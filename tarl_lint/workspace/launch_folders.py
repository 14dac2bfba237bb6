"""Listings of workspace folders for Python launch files: `os.listdir`, `glob.glob` and `Path.glob`, sorted."""

from __future__ import annotations

import fnmatch
import posixpath
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import OpaqueError

ENTRIES: Final = 1_000  # maximum number of entries of a folder that are listed


def listings(inside: Callable[[Any], Path | None]) -> dict[str, Callable[..., Any]]:
    """Return models of the functions that list folders; `inside` returns a path if it is in the workspace.

    The models raise OpaqueError for folders outside the workspace.
    """

    def folder(path: Any) -> Path:
        place = inside(path)
        if place is None:
            raise OpaqueError("a folder outside the workspace")
        return place

    def entries(path: Any) -> list[str]:
        return [one.name for one in _below(folder(path), "*", hidden=True)]

    def found(pattern: Any, *_: Any, **__: Any) -> list[str]:
        home, name = posixpath.split(str(pattern))
        return [str(one) for one in _below(folder(home), name)]

    def below(path: Any, pattern: Any = "*") -> list[FilePath]:
        return [FilePath(one) for one in _below(folder(path), str(pattern), hidden=True)]

    return {
        "os.listdir": entries,
        "glob.glob": found,
        "pathlib.Path.iterdir": below,
        "pathlib.Path.glob": below,
    }


def _below(folder: Path, pattern: str, *, hidden: bool = False) -> list[Path]:
    """Return the sorted matches of a pattern that has no `**` and at most one folder.

    Raises OpaqueError for other patterns.
    """
    parts = pattern.split("/")
    if "**" in pattern or len(parts) > 2 or pattern.count("*") > 4:
        raise OpaqueError("a pattern")
    places = [folder]
    for part in parts:
        names = sorted(one for place in places if place.is_dir() for one in place.iterdir())
        places = [one for one in names if fnmatch.fnmatchcase(one.name, part)
                  and (hidden or not one.name.startswith(".") or part.startswith("."))][:ENTRIES]  # fmt: skip
    return places
