"""The workspaces of started nodes: their packages and message, service and action definitions.

If packages have the same name, the one in the workspace that was searched last counts. All caches of such facts are
keyed by the order of the workspaces.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from tarl_lint.workspace.folders import is_ignored, workspace_root
from tarl_lint.workspace.model import INTERFACES, Package, Workspace
from tarl_lint.workspace.read import read

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

# grows with the folders of started nodes, as sys.path does; the newest comes first
_SEARCHED: list[Path] = []

_CACHES: list[Callable[[], None]] = []  # functions that clear caches of workspace facts

_KEPT: set[Path] = set()  # folders of nodes in packages with COLCON_IGNORE or CATKIN_IGNORE


def search(folder: Path, test: Path | None = None) -> None:
    """Put the packages around `folder` first: those of its repository, or the enclosing ROS workspace.

    If there is neither, take the packages in the folder of the test or, if it does not contain `folder`, in the folder
    above. This is done only if the folder contains both definitions and `folder`.
    """
    root = root_around(folder, test)
    if root is None:
        return
    prefer(root)
    if folder.resolve() not in _KEPT and is_ignored(folder.resolve(), root):
        _KEPT.add(folder.resolve())
        forget()


def root_around(folder: Path, test: Path | None = None) -> Path | None:
    """Return the root that `search` would put first, or None if it would do nothing."""
    return workspace_root(folder.resolve()) or _around_test(folder.resolve(), test)


def prefer(root: Path) -> None:
    """Put a workspace first: its packages count, before others with the same names."""
    if root not in _SEARCHED:
        _SEARCHED.insert(0, root)
        forget()
    elif _SEARCHED[0] != root:  # the caches know each order, so nothing is read again
        _SEARCHED.remove(root)
        _SEARCHED.insert(0, root)


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


def by_order(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Cache the results of a function separately for each order of the workspaces; `forget` clears the cache."""

    @cache
    def known(_order: tuple[Path, ...], *arguments: Any, **named: Any) -> Result:
        return function(*arguments, **named)

    @wraps(function)
    def found(*arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        return known(tuple(_SEARCHED), *arguments, **named)  # type: ignore[arg-type]  # hashable, as with `cache`

    found.cache_info = known.cache_info  # type: ignore[attr-defined]  # as functions with `cache` have
    on_forget(known.cache_clear)
    return found


@cache
def _read(root: Path) -> Workspace:
    return read(root, frozenset(_KEPT))


@by_order
def workspaces() -> tuple[Workspace, ...]:
    """Return descriptions of the workspaces; the workspace that was searched last comes first."""
    return tuple(_read(root) for root in _SEARCHED)


def workspace_around(path: Path) -> Workspace | None:
    """Return the innermost workspace that contains a file or folder, or None if there is none."""
    around = [one for one in workspaces() if path.is_relative_to(one.root)]
    return max(around, key=lambda one: len(one.root.parts), default=None)


@by_order
def packages() -> Mapping[str, Package]:
    """Return the packages by name; the first found wins."""
    found: dict[str, Package] = {}
    for workspace in workspaces():
        for package in workspace.packages:
            found.setdefault(package.name, package)
    return found


@by_order
def workspace_types(part: str) -> Mapping[str, str]:
    """Return the texts of all `.msg`, `.srv` or `.action` files by type name; the first found wins."""
    return {
        f"{package.name}/{file.stem}": file.read_text(encoding="utf-8", errors="replace")
        for package in packages().values()
        for file in package.interfaces
        if file.suffix == f".{part}"
    }


@by_order
def workspace_packages() -> frozenset[str]:
    """Return the packages that contain such files."""
    return frozenset(name for name, package in packages().items() if package.interfaces)


@by_order
def package_folders() -> Mapping[str, Path]:
    """Return the folder of each package that has a package.xml in the searched workspaces."""
    return {
        name: package.folder
        for name, package in packages().items()
        if (package.folder / "package.xml").is_file()
    }


on_forget(_read.cache_clear)
