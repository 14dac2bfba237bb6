"""Find entry points that packages declare: classes of plugins and simulators, functions of console scripts.

`plugin.xml`, robot descriptions, `setup.py`, `setup.cfg`, `pyproject.toml` and `CMakeLists.txt` are read as text;
nothing is run.
"""

# ruff: noqa: PTH113, PTH118, PTH120, PTH123
# Paths are strings here, as in layout.py: trees are large.

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from typing import Final

PACKAGE: Final = ("package.xml", "setup.py", "setup.cfg", "pyproject.toml")
PLACES: Final = (
    "",
    "resource",
    "urdf",
    "description",
    "plugins",
    "config",
)  # folders of a package that may hold descriptions
SETTINGS: Final = ("setup.py", "setup.cfg", "pyproject.toml")
NAMING: Final = (
    "package.xml",
    "CMakeLists.txt",
)  # files that list plugin descriptions, which may have any name
LARGEST: Final = 500_000  # maximum size of a description (bytes)
NAMED: Final = re.compile(r"(?<![\w./])(\w+(?:\.\w+)*)[.:](\w+)(?![\w./])")
XML: Final = re.compile(r"[\w./-]+\.xml\b")


class Declarations:
    """The declarations of each package, read once. Paths are absolute."""

    def __init__(self) -> None:
        self._packages: dict[str, str] = {}  # directory → enclosing package; "" if there is none
        self._named: dict[str, dict[str, set[str]]] = {}

    def of(self, path: str, module: str) -> tuple[str, ...]:
        """Return those names in a module that the package of the module declares as entry points."""
        package = self._package(os.path.dirname(path))
        if not package:
            return ()
        if package not in self._named:
            self._named[package] = _named(package)
        return tuple(sorted(self._named[package].get(module, ())))

    def _package(self, directory: str) -> str:
        if directory not in self._packages:
            parent = os.path.dirname(directory)
            here = any(os.path.isfile(os.path.join(directory, name)) for name in PACKAGE)
            self._packages[directory] = (
                directory if here else "" if parent == directory else self._package(parent)
            )
        return self._packages[directory]


def _named(package: str) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for text in _texts(package):
        for module, name in NAMED.findall(text):
            found.setdefault(module, set()).add(name)
    return found


def _texts(package: str) -> Iterator[str]:
    """Yield the texts that may declare classes and functions."""
    for name in SETTINGS:
        text = _read(os.path.join(package, name))
        if "entry_points" in text or "scripts" in text:
            yield text
    listed = {
        os.path.normpath(os.path.join(package, place.lstrip("/")))
        for name in NAMING
        for place in XML.findall(_read(os.path.join(package, name)))
    }
    inside = sorted(path for path in listed if path.startswith(package + os.sep))
    for path in dict.fromkeys([*_descriptions(package), *inside]):
        text = _read(path)
        if "<plugin" in text or "<class" in text:
            yield text


def _descriptions(package: str) -> Iterator[str]:
    """Yield the files that may describe plugins."""
    for place in PLACES:
        directory = os.path.join(package, place) if place else package
        try:
            names = sorted(os.listdir(directory))  # noqa: PTH208
        except OSError:
            continue
        for name in names:
            if name.endswith((".urdf", ".xacro")) or (name.endswith(".xml") and "plugin" in name):
                yield os.path.join(directory, name)


def _read(path: str) -> str:
    """Return the text of a file; "" if it is missing or too large."""
    try:
        if not os.path.isfile(path) or os.path.getsize(path) > LARGEST:  # noqa: PTH202
            return ""
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""
