"""Module names and ROS packages of files, derived from directories."""

# ruff: noqa: PTH113, PTH120
# Paths are strings here: trees are large, and Path objects cost several times as much.

from __future__ import annotations

import os
from pathlib import Path


class Layout:
    """Derives the names of modules and packages; examines each directory once. Paths are absolute.

    The nearest import root counts. An import root is a script's own directory, the directory that holds the
    outermost package (whatever its name: `src/`, `include/`, `scripts/`), or a `package_dir` in setup.py or
    setup.cfg.
    """

    def __init__(self) -> None:
        self._prefixes: dict[str, str] = {}
        self._declared: dict[str, dict[str, str]] = {}
        self._ros: dict[str, str] = {}

    def module(self, path: str) -> tuple[str, bool]:
        """Return a file's dotted name, and whether it is a package's `__init__.py`."""
        directory, base = os.path.split(path)
        stem = base[:-3] if base.endswith(".py") else base
        prefix = self._prefix(directory)
        if stem == "__init__" and prefix:
            return prefix, True
        return f"{prefix}.{stem}" if prefix else stem, False

    def ros_package(self, path: str) -> str:
        """Return the name in the nearest package.xml above a file; "" if there is none."""
        return self._ros_of(os.path.dirname(path))

    def _prefix(self, directory: str) -> str:
        """Return the prefix of module names in a directory; "" at an import root."""
        if directory not in self._prefixes:
            self._prefixes[directory] = self._ask_prefix(directory)
        return self._prefixes[directory]

    def _ask_prefix(self, directory: str) -> str:
        declared = self._roots(directory)
        if directory in declared:
            return declared[directory]
        parent, base = os.path.split(directory)
        if parent == directory or not os.path.isfile(f"{directory}/__init__.py"):
            return ""
        prefix = self._prefix(parent)
        return f"{prefix}.{base}" if prefix else base

    def _roots(self, directory: str) -> dict[str, str]:
        """Return directory → package for every `package_dir` at or above a directory."""
        if directory not in self._declared:
            parent = os.path.dirname(directory)
            above = {} if parent == directory else self._roots(parent)
            own = _package_dirs(Path(directory))
            self._declared[directory] = above | own if own else above
        return self._declared[directory]

    def _ros_of(self, directory: str) -> str:
        if directory not in self._ros:
            parent = os.path.dirname(directory)
            name = _manifest_name(Path(directory))
            self._ros[directory] = name or ("" if parent == directory else self._ros_of(parent))
        return self._ros[directory]


def _manifest_name(directory: Path) -> str:
    """Return the name in the package.xml of a directory; "" if there is no such file."""
    if not (directory / "package.xml").is_file():
        return ""
    from tarl_lint.workspace.manifests import manifest

    return manifest(directory)[0].name


def _package_dirs(directory: Path) -> dict[str, str]:
    """Return the `package_dir` that setup.cfg and setup.py declare in a directory, as directory → package."""
    if not any("package_dir" in _read(directory / name) for name in ("setup.cfg", "setup.py")):
        return {}
    from tarl_lint.workspace.setup_files import setup

    return {
        os.path.normpath(directory / place): package for package, place in setup(directory).folders.items()
    }


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8", errors="replace") if path.is_file() else ""
    except OSError:
        return ""
