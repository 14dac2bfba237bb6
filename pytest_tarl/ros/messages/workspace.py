"""The workspaces of started nodes: their packages and message, service and action definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

from tarl_lint.workspace.folders import is_ignored, workspace_root
from tarl_lint.workspace.model import INTERFACES, Package, Workspace
from tarl_lint.workspace.read import read

_SEARCHED: list[Path] = []  # grows with the folders of started nodes, as sys.path does

_CACHES: list[Callable[[], None]] = []  # functions that clear caches of workspace facts

_KEPT: set[Path] = set()  # folders of nodes in packages with COLCON_IGNORE or CATKIN_IGNORE


def search(folder: Path, test: Path | None = None) -> None:
    """Add the packages around `folder`: those of its repository, or the enclosing ROS workspace.

    Without either, add those in the folder of the test or beside it, if that contains definitions and `folder`.
    """
    root = workspace_root(folder.resolve()) or _around_test(folder.resolve(), test)
    if root is None:
        return
    if not any(root.is_relative_to(known) for known in _SEARCHED):
        _SEARCHED.append(root)
        forget()
    if folder.resolve() not in _KEPT and is_ignored(folder.resolve(), root):
        _KEPT.add(folder.resolve())
        forget()


def _around_test(folder: Path, test: Path | None) -> Path | None:
    """Return the folder of a test, or else the folder above, that contains `folder`, if it has definitions."""
    around = () if test is None else (test.resolve(), test.resolve().parent)
    nearest = next((one for one in around if folder.is_relative_to(one)), None)
    return nearest if nearest is not None and _has_definitions(nearest) else None


def _has_definitions(folder: Path) -> bool:
    """Return whether a folder contains definitions of messages, services or actions in packages below it."""
    patterns = (f"{above}/{kind}/*.{kind}" for above in ("*", "*/*") for kind in INTERFACES)
    return any(next(folder.glob(pattern), None) for pattern in patterns)


def on_forget(clear: Callable[[], None]) -> None:
    """Register a function that empties a cache of facts about the workspaces."""
    _CACHES.append(clear)


def forget() -> None:
    """Empty all caches of facts about the workspaces, which are then read again on next use."""
    for clear in _CACHES:
        clear()


@cache
def workspaces() -> tuple[Workspace, ...]:
    """Return descriptions of the workspaces, in the order in which nodes were started from them."""
    return tuple(read(root, frozenset(_KEPT)) for root in _SEARCHED)


@cache
def packages() -> Mapping[str, Package]:
    """Return the packages by name; the first found wins."""
    found: dict[str, Package] = {}
    for workspace in workspaces():
        for package in workspace.packages:
            found.setdefault(package.name, package)
    return found


@cache
def workspace_types(part: str) -> Mapping[str, str]:
    """Return the texts of all `.msg`, `.srv` or `.action` files by type name; the first found wins."""
    return {
        f"{package.name}/{file.stem}": file.read_text(encoding="utf-8", errors="replace")
        for package in packages().values()
        for file in package.interfaces
        if file.suffix == f".{part}"
    }


@cache
def workspace_packages() -> frozenset[str]:
    """Return the packages that contain such files."""
    return frozenset(name for name, package in packages().items() if package.interfaces)


@cache
def package_folders() -> Mapping[str, Path]:
    """Return the folder of each package that has a package.xml in the searched workspaces."""
    return {
        name: package.folder
        for name, package in packages().items()
        if (package.folder / "package.xml").is_file()
    }


for known in (workspaces, packages, workspace_types, workspace_packages, package_folders):
    on_forget(known.cache_clear)
