"""Module names and ROS packages of files, derived from directories."""

# ruff: noqa: PTH113, PTH120
# Paths are strings here: trees are large, and Path objects cost several times as much.

from __future__ import annotations

import os
import re
from pathlib import Path

from tarl_lint.trees import walk

_SETUP = frozenset({"setup", "generate_distutils_setup"})


class Layout:
    """Names modules and packages; examines each directory once. Paths are absolute.

    The nearest import root counts: a script's own directory, the directory that holds the outermost package
    (`src/`, `include/`, `scripts/` alike), or the `package_dir` in setup.py or setup.cfg.
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
        """Return the name in the nearest package.xml above a file, "" if there is none."""
        return self._ros_of(os.path.dirname(path))

    def _prefix(self, directory: str) -> str:
        """Return the prefix of module names in a directory, "" at an import root."""
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
    try:
        text = (directory / "package.xml").read_text("utf-8", errors="replace")
    except OSError:
        return ""
    found = re.search(r"<name>\s*([^<\s]+)\s*</name>", text)
    return found[1] if found else directory.name


def _package_dirs(directory: Path) -> dict[str, str]:
    """Return the `package_dir` that setup.cfg and setup.py in a directory declare, as directory → package."""
    pairs = {**_from_setup_cfg(directory / "setup.cfg"), **_from_setup_py(directory / "setup.py")}
    return {os.path.normpath(directory / place): package for package, place in pairs.items()}


def _from_setup_cfg(path: Path) -> dict[str, str]:
    text = _read(path)
    if "package_dir" not in text:
        return {}
    import configparser

    parser = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(text)
        lines = parser.get("options", "package_dir", fallback="").splitlines()
    except configparser.Error:
        return {}
    pairs = (line.partition("=") for line in lines if "=" in line)
    return {package.strip(): place.strip() for package, _, place in pairs}


def _from_setup_py(path: Path) -> dict[str, str]:
    text = _read(path)
    if "package_dir" not in text:
        return {}
    import ast

    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    calls = (node for node in walk(tree) if isinstance(node, ast.Call))
    setups = (call for call in calls if _name(call.func) in _SETUP)
    for value in (k.value for call in setups for k in call.keywords if k.arg == "package_dir"):
        if isinstance(value, ast.Dict):
            return {
                str(key.value): str(item.value)
                for key, item in zip(value.keys, value.values, strict=True)
                if isinstance(key, ast.Constant) and isinstance(item, ast.Constant)
            }
    return {}


def _name(function: object) -> object:
    """Return the last name of a called expression: `setup` of `setuptools.setup`."""
    return getattr(function, "attr", None) or getattr(function, "id", None)


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8", errors="replace")
    except OSError:
        return ""
