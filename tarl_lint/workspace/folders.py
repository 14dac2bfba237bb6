"""Walk the source folders of a workspace, and find a workspace's root."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from tarl_lint.workspace.model import Problem

LIMIT: Final = 20_000  # maximum number of folders of one workspace
IGNORE: Final = ("COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE")
MARKERS: Final = (*IGNORE, "pyvenv.cfg", ".catkin")
_BUILT: Final = frozenset({"build", "install", "log", "devel", "logs"})
_NEVER: Final = frozenset({"__pycache__", "node_modules", "site-packages", "dist-packages"})


def folders(
    root: Path,
    kept: frozenset[Path] = frozenset(),
    ignored: list[Path] | None = None,
    unread: list[Problem] | None = None,
) -> Iterator[tuple[Path, list[str]]]:
    """Yield the source folders with their files, sorted; skip build output.

    Also skip a folder with a marker such as COLCON_IGNORE, unless it contains one of the folders in `kept`. Markers
    that a person (not a tool) has placed are added to `ignored`. Folders that cannot be read are added to `unread`.
    """
    unread = [] if unread is None else unread

    def refused(error: OSError) -> None:
        unread.append(Problem(Path(error.filename), 0, f"the folder cannot be read: {error.strerror}"))

    for looked, (folder, names, files) in enumerate(os.walk(root, onerror=refused)):
        if looked >= LIMIT:
            unread.append(Problem(root, 0, f"it has more than {LIMIT:,} folders; the others are not read"))
            return
        markers = [one for one in MARKERS if looked and one in files]
        if markers and not any(one.is_relative_to(folder) for one in kept):
            names.clear()
            if ignored is not None and markers[0] in IGNORE:
                ignored.append(Path(folder, markers[0]))
            continue
        names[:] = sorted(name for name in names if _holds_sources(folder, name))
        yield Path(folder), sorted(files)


def _holds_sources(folder: str, name: str) -> bool:
    if name.startswith(".") or name in _NEVER:
        return False
    return name not in _BUILT or Path(folder, name, "__init__.py").is_file()


def is_ignored(folder: Path, root: Path) -> bool:
    """Return whether a folder or one of its parents below the root has a marker such as COLCON_IGNORE."""
    around = [one for one in (folder, *folder.parents) if one != root and one.is_relative_to(root)]
    return any((one / marker).exists() for one in around for marker in MARKERS)


def workspace_root(path: Path) -> Path | None:
    """Return the root of the workspace around a file or folder; None without a package or repository.

    The root is the `src` of a colcon or catkin workspace if there is one, else the top of the git repository, else
    the folder that contains the outermost package. For a path beside `src`, it is the folder that contains `src`.
    """
    around = (path, *path.parents) if path.is_dir() else tuple(path.parents)
    for folder in around:
        if folder.name == "src" and any(
            (folder.parent / one).is_dir() for one in ("build", "install", "devel")
        ):
            return folder
        if (folder / ".git").exists():
            return folder
    packages = [folder for folder in around if (folder / "package.xml").is_file()]
    if not packages:
        return next((folder for folder in around if has_packages(folder / "src")), None)
    above = packages[-1].parent
    return above if above != Path(above.anchor) else packages[-1]


def has_packages(folder: Path) -> bool:
    """Return whether a folder contains packages, directly or in repositories."""
    return any(next(folder.glob(pattern), None) for pattern in ("*/package.xml", "*/*/package.xml"))
