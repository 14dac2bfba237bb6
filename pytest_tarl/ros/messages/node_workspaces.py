"""The workspaces of started nodes: packages, and definitions of messages, services and actions.

If packages have the same name, the one in the most recently searched workspace wins. All caches of such facts are keyed
by the order of the workspaces.
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

# newest first; grows with the folders of started nodes, as sys.path does
_SEARCHED: list[Path] = []

_CACHES: list[Callable[[], None]] = []  # functions that clear caches of facts about workspaces

_KEPT: set[Path] = set()  # folders of nodes in packages with COLCON_IGNORE or CATKIN_IGNORE


def search(folder: Path, test: Path | None = None) -> None:
    """Put the packages around `folder` first: those of its repository, or of the ROS workspace around it.

    If there is neither, use the packages in the test's folder or, if it does not contain `folder`, in the folder above.
    This requires that the chosen folder contains definitions as well as `folder`.
    """
    root = root_around(folder, test)
    if root is None:
        return
    prefer(root)
    if folder.resolve() not in _KEPT and is_ignored(folder.resolve(), root):
        _KEPT.add(folder.resolve())
        forget()


def root_around(folder: Path, test: Path | None = None) -> Path | None:
    """Return the root that `search` would put first, or None if there is none."""
    return workspace_root(folder.resolve()) or _around_test(folder.resolve(), test)


def prefer(root: Path) -> None:
    """Put a workspace first, so that its packages win over others with the same names."""
    if root not in _SEARCHED:
        _SEARCHED.insert(0, root)
        forget()
    elif _SEARCHED[0] != root:  # the caches know each order, so nothing is read again
        _SEARCHED.remove(root)
        _SEARCHED.insert(0, root)


def _around_test(folder: Path, test: Path | None) -> Path | None:
    """Return the folder of a test, or the one above, if it contains `folder` and has definitions."""
    around = () if test is None else (test.resolve(), test.resolve().parent)
    nearest = next((one for one in around if folder.is_relative_to(one)), None)
    return nearest if nearest is not None and _has_definitions(nearest) else None


def _has_definitions(folder: Path) -> bool:
    """Return whether packages below a folder define messages, services or actions."""
    patterns = (f"{above}/{kind}/*.{kind}" for above in ("*", "*/*") for kind in INTERFACES)
    return any(next(folder.glob(pattern), None) for pattern in patterns)


def on_forget(clear: Callable[[], None]) -> None:
    """Register a function that clears a cache of facts about workspaces."""
    _CACHES.append(clear)


def forget() -> None:
    """Clear all caches of facts about workspaces, so that they are read again when needed."""
    for clear in _CACHES:
        clear()


def by_order(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Cache a function's results separately for each order of the workspaces, until `forget`."""

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
    """Return descriptions of the workspaces, the most recently searched one first."""
    return tuple(_read(root) for root in _SEARCHED)


def workspace_around(path: Path) -> Workspace | None:
    """Return the innermost workspace that contains a file or folder, or None."""
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
