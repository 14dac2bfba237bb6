"""Message, service and action files of the user's own packages, found in the workspace that a node is started from."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

_SKIPPED = {"build", "install", "log", "devel", "node_modules", "__pycache__", "site-packages"}
_LIMIT = 20_000  # folders that are looked into
_SEARCHED: list[Path] = []  # like sys.path: it grows with the folders that nodes are started from


def search(folder: Path) -> None:
    """Find definitions in the workspace of `folder` too: the repository or the ROS packages around it."""
    root = _root(folder.resolve())
    if root is not None and not any(root.is_relative_to(known) for known in _SEARCHED):
        _SEARCHED.append(root)
        workspace_types.cache_clear()
        workspace_packages.cache_clear()
        package_folders.cache_clear()


@cache
def workspace_types(part: str) -> Mapping[str, str]:
    """Return the text of all `.msg`, `.srv` or `.action` files by type name, the first found of each."""
    found: dict[str, str] = {}
    for root in _SEARCHED:
        for file in _files(root, part):
            name = f"{_package_name(file.parent.parent)}/{file.stem}"
            found.setdefault(name, file.read_text(encoding="utf-8", errors="replace"))
    return found


@cache
def workspace_packages() -> frozenset[str]:
    """Return the packages that have such files."""
    return frozenset(
        name.partition("/")[0] for part in ("msg", "srv", "action") for name in workspace_types(part)
    )


@cache
def package_folders() -> Mapping[str, Path]:
    """Return the folder of each package that has a package.xml in the searched workspaces."""
    found: dict[str, Path] = {}
    for root in _SEARCHED:
        for folder, files in _folders(root):
            if "package.xml" in files:
                found.setdefault(_package_name(folder), folder)
    return found


def _root(folder: Path) -> Path | None:
    """Return the outermost folder that belongs to the same repository, else the one that holds the ROS package."""
    above = (folder, *folder.parents)
    for candidate in above:
        if (candidate / ".git").exists():
            return candidate
    for candidate in above:
        if (candidate / "package.xml").is_file():
            return candidate.parent if candidate.parent != Path(candidate.anchor) else candidate
    return None


def _folders(root: Path) -> Iterator[tuple[Path, list[str]]]:
    """Walk through the folders that hold sources."""
    for looked, (folder, names, files) in enumerate(os.walk(root)):
        if looked > _LIMIT:
            return
        names[:] = sorted(name for name in names if name not in _SKIPPED and not name.startswith("."))
        yield Path(folder), files


def _files(root: Path, part: str) -> Iterator[Path]:
    for folder, files in _folders(root):
        if folder.name == part:
            yield from (folder / file for file in sorted(files) if file.endswith(f".{part}"))


def _package_name(folder: Path) -> str:
    try:
        name = ElementTree.parse(folder / "package.xml").getroot().findtext("name")  # noqa: S314 (the user's own file)
    except (OSError, ElementTree.ParseError):
        name = None
    return (name or "").strip() or folder.name
