"""`tarl workspace`: list packages, nodes, launch files and unreadable files."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from pytest_tarl.errors import SettingsError
from tarl_lint.workspace.examination import Examined, examined
from tarl_lint.workspace.model import Package, Problem, Workspace
from tarl_lint.workspace.read import read

FORMAT_VERSION = 1  # new keys do not increase the version
WIDEST = 44  # maximum characters of a list in the table; the JSON has the whole list
LONGEST = 100  # maximum characters of a list below the table
HEADINGS = ("package", "kind", "nodes and scripts", "C++ nodes", "launch files", "not read")


def described(folder: Path) -> Examined:
    """Read the workspace in a folder. Raise SettingsError if there is no folder or no package."""
    if folder.is_file():
        raise SettingsError(f"{folder}: this is a file. Name the folder of a workspace.")
    if not folder.is_dir():
        raise SettingsError(f"{folder}: no such folder.")
    found = read(folder)
    if not found.packages:
        raise SettingsError(
            f"{folder}: there is no package.xml at or below it. Name the folder of a workspace."
        )
    return examined(found)


def table(found: Examined) -> Iterator[str]:
    """Yield the table, then foreign nodes and unreadable files."""
    workspace = found.workspace
    rows = [HEADINGS, *map(_row, workspace.packages)]
    optional = HEADINGS.index("C++ nodes")
    filled = any(row[optional] for row in rows[1:])
    used = [column for column in range(len(HEADINGS)) if column != optional or filled]
    widths = {column: max(len(row[column]) for row in rows) for column in used}
    for row in rows:
        yield "  ".join(row[column].ljust(widths[column]) for column in used).rstrip()
    yield from _elsewhere(found)
    problems = [f"{_place(workspace, one)}: {one.reason}" for one in workspace.problems()]
    problems += [
        f"{_relative(workspace, one.marker)}: hides the package {one.package.name}"
        for one in workspace.hidden
    ]
    problems += [found.note] if found.note else []
    if problems:
        yield ""
        yield "Not read:"
        yield from (f"  {one}" for one in problems)


def _elsewhere(found: Examined) -> Iterator[str]:
    """Yield the number of C++ nodes, what is outside the workspace, and what is known only on the robot."""
    compiled = sum(len(one.compiled) + len(one.components) for one in found.workspace.packages)
    lines = [f"C++ nodes: {compiled} (known by interface only)"] if compiled else []
    if found.foreign:
        lines.append(f"Started from packages outside the workspace: {_shortened(found.foreign, LONGEST)}")
    if found.absent:
        lines.append(
            f"Included launch files of packages outside the workspace: {_shortened(found.absent, LONGEST)}"
        )
    if found.symbolic:
        count = f"{found.symbolic} value{'' if found.symbolic == 1 else 's'}"
        lines.append(f"Known on the robot only: {count} in launch files (tarl-lint --launch FILE lists them)")
    if lines:
        yield ""
        yield from lines


def document(found: Examined) -> str:
    """Return the whole description as JSON; paths are relative to `root`."""
    workspace = found.workspace
    packages = [_package(workspace, one) for one in workspace.packages]
    hidden = [
        {"name": one.package.name, "marker": _relative(workspace, one.marker)} for one in workspace.hidden
    ]
    whole = {
        "version": FORMAT_VERSION,
        "root": str(workspace.root),
        "packages": packages,
        "hidden": hidden,
        "started_from_elsewhere": list(found.foreign),
        "included_from_elsewhere": list(found.absent),
        "known_on_robot_only": found.symbolic,
        "problems": [_problem(workspace, one) for one in workspace.unread],
        "note": found.note,
    }
    return json.dumps(whole, indent=2) + "\n"


def _row(package: Package) -> tuple[str, ...]:
    nodes = [one.name for one in package.executables]
    launch = [path.name for path in package.launch_files]
    unread = str(len(package.problems)) if package.problems else ""
    compiled = (*package.compiled, *package.components)
    return (package.name, package.kind, *map(_shortened, (nodes, compiled, launch)), unread)


def _shortened(names: Sequence[str], most: int = WIDEST) -> str:
    """Return as many names as fit, and the number of those left out."""
    shown: list[str] = []
    for name in names:
        if shown and len(", ".join([*shown, name])) > most:
            return f"{', '.join(shown)} and {len(names) - len(shown)} more"
        shown.append(name)
    return ", ".join(shown)


def _place(workspace: Workspace, problem: Problem) -> str:
    path = _relative(workspace, problem.file)
    return f"{path}:{problem.line}" if problem.line else path


def _problem(workspace: Workspace, problem: Problem) -> dict[str, object]:
    return {"file": _relative(workspace, problem.file), "line": problem.line, "reason": problem.reason}


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
        "compiled_nodes": list(package.compiled),
        "components": list(package.components),
        "modules": [{"name": one.name, "path": _relative(workspace, one.path)} for one in package.modules],
        "interfaces": paths(package.interfaces),
        "configurations": paths(package.configurations),
        "launch_files": paths(package.launch_files),
        "parameter_files": paths(package.parameter_files),
        "problems": [_problem(workspace, one) for one in package.problems],
    }


def _relative(workspace: Workspace, path: Path) -> str:
    return path.relative_to(workspace.root).as_posix() if path.is_relative_to(workspace.root) else str(path)
