"""Read `package.xml`: name, build type and dependencies of a package."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from xml.etree import ElementTree

from tarl_lint.workspace.bounded_files import UnreadableError, read_bytes
from tarl_lint.workspace.model import Kind, Problem

LARGEST: Final = 200_000  # maximum size of a manifest (bytes)
_DEPENDS: Final = frozenset({"depend", "build_depend", "exec_depend", "run_depend", "buildtool_depend", "test_depend",
                             "build_export_depend", "group_depend"})  # fmt: skip
_BUILD_TYPES: Final[tuple[Kind, ...]] = ("ament_python", "ament_cmake", "catkin", "cmake")


@dataclass(frozen=True, slots=True)
class Manifest:
    """The contents of `package.xml`. `plugins` are the files that describe the package's nodelets."""

    name: str
    kind: Kind
    dependencies: tuple[str, ...] = ()
    plugins: tuple[str, ...] = ()


def manifest(folder: Path) -> tuple[Manifest, list[Problem]]:
    """Return a folder's manifest and its problems; without a name, it gets the folder's."""
    path = folder / "package.xml"
    root, problem = _root(path)
    if root is None:
        return Manifest(folder.name, _kind(folder, "", ())), [Problem(path, 0, problem)]
    name = (root.findtext("name") or "").strip()
    depends = tuple(sorted({tag.text.strip() for tag in root if tag.tag in _DEPENDS and tag.text}))
    stated = (root.findtext("export/build_type") or "").strip()
    problems = [] if name else [Problem(path, 0, "it has no <name>")]
    exported = [one.get("plugin", "") for one in root.findall("export/nodelet")]
    plugins = tuple(one.removeprefix("${prefix}/") for one in exported if one)
    return Manifest(name or folder.name, _kind(folder, stated, depends), depends, plugins), problems


def plugins(folder: Path, files: Sequence[str]) -> tuple[list[str], list[Problem]]:
    """Return the names of the nodelets that these files of a package describe."""
    names: list[str] = []
    problems: list[Problem] = []
    for file in files:
        path = folder / file
        root, problem = _root(path)
        if root is None:
            problems.append(Problem(path, 0, problem))
            continue
        names += [one.get("name") or one.get("type", "").replace("::", "/") for one in root.iter("class")]
    return [one for one in names if one], problems


def _root(path: Path) -> tuple[ElementTree.Element | None, str]:
    try:
        text = read_bytes(path, LARGEST)
    except UnreadableError as reason:
        return None, str(reason)
    if re.search(rb"<!(DOCTYPE|ENTITY)", text):
        return None, "it declares entities"
    try:
        return ElementTree.fromstring(text), ""  # noqa: S314 - without entities, nothing expands
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        return None, f"it is not XML: {error}"


def _kind(folder: Path, stated: str, depends: tuple[str, ...]) -> Kind:
    """Return the build type: as stated, or guessed from dependencies and files."""
    for kind in _BUILD_TYPES:
        if stated == kind:
            return kind
    if "catkin" in depends:
        return "catkin"
    if any(one.startswith("ament_cmake") for one in depends):
        return "ament_cmake"
    if (folder / "CMakeLists.txt").is_file():
        return "catkin" if not stated else "cmake"
    return "ament_python" if (folder / "setup.py").is_file() else "unknown"
