"""`tarl workspace`: list the packages of a workspace, their nodes and launch files, and files that cannot be read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from pytest_tarl.errors import SettingsError
from tarl_lint.workspace.model import Package, Problem, Workspace
from tarl_lint.workspace.read import read

FORMAT_VERSION = 1
WIDEST = 44  # maximum number of characters of a list in the table; the JSON output has the whole list
HEADINGS = ("package", "kind", "nodes and scripts", "launch files", "not read")


def described(folder: Path) -> Workspace:
    """Read the workspace below a folder. Raise SettingsError if there is no folder or no package."""
    if not folder.is_dir():
        raise SettingsError(f"{folder}: no such folder.")
    found = read(folder)
    if not found.packages:
        raise SettingsError(
            f"{folder}: there is no package.xml at or below it. Name the folder of a workspace."
        )
    return found


def table(workspace: Workspace) -> Iterator[str]:
    """Yield the lines of the table, then the files that could not be read."""
    rows = [HEADINGS, *map(_row, workspace.packages)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADINGS))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
    problems = [f"{_place(workspace, one)}: {one.reason}" for one in workspace.problems()]
    problems += [
        f"{_relative(workspace, one.marker)}: hides the package {one.package.name}"
        for one in workspace.hidden
    ]
    if problems:
        yield ""
        yield "Not read:"
        yield from (f"  {one}" for one in problems)


def document(workspace: Workspace) -> str:
    """Return the whole description as JSON; paths are relative to `root`."""
    packages = [_package(workspace, one) for one in workspace.packages]
    hidden = [
        {"name": one.package.name, "marker": _relative(workspace, one.marker)} for one in workspace.hidden
    ]
    whole = {
        "version": FORMAT_VERSION,
        "root": str(workspace.root),
        "packages": packages,
        "hidden": hidden,
    }
    return json.dumps(whole, indent=2) + "\n"


def _row(package: Package) -> tuple[str, ...]:
    nodes = [one.name for one in package.executables]
    launch = [path.name for path in package.launch_files]
    unread = str(len(package.problems)) if package.problems else ""
    return package.name, package.kind, _shortened(nodes), _shortened(launch), unread


def _shortened(names: Sequence[str]) -> str:
    """Return as many names as fit, and how many were omitted."""
    shown: list[str] = []
    for name in names:
        if shown and len(", ".join([*shown, name])) > WIDEST:
            return f"{', '.join(shown)} and {len(names) - len(shown)} more"
        shown.append(name)
    return ", ".join(shown)


def _place(workspace: Workspace, problem: Problem) -> str:
    path = _relative(workspace, problem.file)
    return f"{path}:{problem.line}" if problem.line else path


def _package(workspace: Workspace, package: Package) -> dict[str, object]:
    def paths(files: Sequence[Path]) -> list[str]:
        return [_relative(workspace, one) for one in files]

    return {
        "name": package.name,
        "kind": package.kind,
        "folder": _relative(workspace, package.folder),
        "dependencies": list(package.dependencies),
        "nodes": [
            {"name": one.name, "file": one.path and _relative(workspace, one.path), "entry": one.entry}
            for one in package.executables
        ],
        "modules": [{"name": one.name, "path": _relative(workspace, one.path)} for one in package.modules],
        "interfaces": paths(package.interfaces),
        "configurations": paths(package.configurations),
        "launch_files": paths(package.launch_files),
        "parameter_files": paths(package.parameter_files),
        "problems": [
            {"file": _relative(workspace, one.file), "line": one.line, "reason": one.reason}
            for one in package.problems
        ],
    }


def _relative(workspace: Workspace, path: Path) -> str:
    return path.relative_to(workspace.root).as_posix() if path.is_relative_to(workspace.root) else str(path)
