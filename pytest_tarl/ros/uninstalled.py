"""Import workspace modules that no package installs, and warn that these imports would fail on the robot."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import FrameType, ModuleType

from pytest_tarl.ros.messages.node_workspaces import on_forget, workspace_around, workspaces
from tarl_lint.workspace.folders import folders

_MISSING = frozenset({"AttributeError", "ImportError", "ModuleNotFoundError", "Exception", "BaseException"})
_PROJECT = ("pyproject.toml", "setup.py", "setup.cfg")


class UninstalledFinder:
    """The last finder on `sys.meta_path`, for names that no other finder knows. `taken` maps found modules to files."""

    def __init__(self) -> None:
        self.taken: dict[str, Path] = {}

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a top-level module in the importer's package or in the workspace."""
        if path is not None or "." in name:
            return None
        importer = _importer(sys._getframe(1))
        if importer is None or is_optional(importer.f_code.co_filename, importer.f_lineno):
            return None
        place = _nearest(name, Path(importer.f_code.co_filename).resolve())
        if place is None:
            return None
        if not _is_of_project(place):
            self.taken[name] = place
        return PathFinder.find_spec(name, [str(place.parent)])

    def notes(self) -> tuple[str, ...]:
        """Return sentences for the user about modules that were found this way."""
        return tuple(
            f"{name} was imported from {place}, which no package of the workspace installs: on the robot the import "
            "fails unless the folder is on PYTHONPATH. Name it in the setup.py of its package."
            for name, place in sorted(self.taken.items())
        )


def _importer(frame: FrameType | None) -> FrameType | None:
    """Return the importing frame, if it runs a workspace file."""
    while frame is not None and (
        "importlib" in frame.f_code.co_filename
        or frame.f_globals.get("__name__", "").startswith("pytest_tarl")
    ):
        frame = frame.f_back
    if frame is None:
        return None
    file = Path(frame.f_code.co_filename)
    return frame if any(file.is_relative_to(one.root) for one in workspaces()) else None


def _nearest(name: str, importer: Path) -> Path | None:
    """Return the only module of this name in the importer's package or, if it has none, in the workspace.

    If there are several, prefer those outside any Python package, then those that a Python project installs. Return
    None unless exactly one is left.
    """
    workspace = workspace_around(importer)
    if workspace is None:
        return None
    found = [one for one in _modules(workspace.root).get(name, ()) if one != importer]
    own = workspace.package_of(importer)
    chosen = [one for one in found if own is not None and one.is_relative_to(own.folder)] or found
    for preferred in (_is_top_level, _is_of_project):
        if len(chosen) > 1:
            chosen = [one for one in chosen if preferred(one)] or chosen
    return chosen[0] if len(chosen) == 1 else None


def _is_top_level(place: Path) -> bool:
    """Return whether a module is outside any Python package, so that `import NAME` can find it."""
    return not (place.parent / "__init__.py").is_file()


def _is_of_project(place: Path) -> bool:
    """Return whether a module is installed by a Python project without `package.xml`."""
    above = place.parent
    projects = (above, above.parent) if above.name == "src" else (above,)
    return any(
        not (one / "package.xml").is_file() and any((one / name).is_file() for name in _PROJECT)
        for one in projects
    )


def candidates(name: str) -> tuple[Path, ...]:
    """Return the files and folders in all workspaces that could be the top-level module `name`."""
    return tuple(place for workspace in workspaces() for place in _modules(workspace.root).get(name, ()))


@cache
def _modules(root: Path) -> dict[str, tuple[Path, ...]]:
    """Return the files and folders in a workspace that could be top-level modules, by name."""
    found: dict[str, tuple[Path, ...]] = {}
    for folder, files in folders(root):
        if folder.name in ("launch", "test", "tests"):
            continue
        for place in _importable(folder, files):
            found[place.stem] = (*found.get(place.stem, ()), place)
    return found


def _importable(folder: Path, files: list[str]) -> Iterator[Path]:
    if "__init__.py" in files:
        yield folder
    elif any(name.endswith(".py") for name in files) and folder not in {
        one.folder for workspace in workspaces() for one in workspace.packages
    }:
        yield folder  # a namespace package
    yield from (folder / name for name in files if name.endswith(".py") and name.removesuffix(".py").isidentifier()
                and name not in ("__init__.py", "setup.py"))  # fmt: skip


@cache
def is_optional(file: str, line: int) -> bool:
    """Return whether a line is in a `try` that catches failed imports."""
    try:
        tree = ast.parse(Path(file).read_bytes())
    except (OSError, SyntaxError, ValueError):
        return False
    for node in ast.walk(tree):
        if isinstance(node, ast.Try) and node.body[0].lineno <= line <= (node.body[-1].end_lineno or line):
            caught = {name.id for one in node.handlers for name in ast.walk(one.type or ast.Name("Exception"))
                      if isinstance(name, ast.Name)}  # fmt: skip
            if caught & _MISSING:
                return True
    return False


for known in (_modules, is_optional):
    on_forget(known.cache_clear)
