"""Find the import path and module name of a node's file; restore the interpreter after the node has run."""

from __future__ import annotations

import contextlib
import linecache
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

_BUILT = ("build", "install", "devel")  # folders of build output, beside the `src` of a workspace
_PACKAGE = ("package.xml", "pyproject.toml", "setup.py")


def importable(path: Path) -> tuple[Path, str]:
    """Return the folder from which to import a file, and its module name (`driver`, `robot.driver`)."""
    root, parts = path.parent, [path.stem]
    while (root / "__init__.py").is_file():
        root, parts = root.parent, [root.name, *parts]
    return root, ".".join(parts)


@lru_cache(maxsize=256)
def workspace(path: Path) -> Path:
    """Return the root folder of a node's project.

    This is the first of the following that exists:

    - the git repository
    - the folder above the `src` of a colcon or catkin workspace
    - the outermost folder with a `package.xml`, `pyproject.toml` or `setup.py`
    - the folder from which the node is imported
    """
    file = path.resolve()
    for folder in file.parents:
        if (folder / ".git").exists():
            return folder
        if folder.name == "src" and any((folder.parent / one).is_dir() for one in _BUILT):
            return folder.parent
    packages = [one for one in file.parents if any((one / name).is_file() for name in _PACKAGE)]
    return packages[-1] if packages else importable(file)[0]


def on_search_path(*folders: Path) -> None:
    """Move these folders to the front of the search path, in this order."""
    for folder in reversed(folders):
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))


@contextlib.contextmanager
def restored_interpreter() -> Iterator[None]:
    """Restore the search path and `__main__` on exit, because a script may change them."""
    path, main = list(sys.path), sys.modules["__main__"]
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules["__main__"] = main


@contextlib.contextmanager
def shown(path: Path, text: str) -> Iterator[None]:
    """Make tracebacks and `inspect` show the text that runs, instead of the file on disk."""
    before = linecache.cache.pop(str(path), None)
    linecache.cache[str(path)] = (len(text), None, text.splitlines(keepends=True), str(path))
    try:
        yield
    finally:
        linecache.cache.pop(str(path), None)
        if before is not None:
            linecache.cache[str(path)] = before
