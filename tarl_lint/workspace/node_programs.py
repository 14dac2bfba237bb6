"""Find the Python program that a node of a launch file runs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from tarl_lint.workspace.launch_model import LaunchedNode
from tarl_lint.workspace.model import Workspace


@dataclass(frozen=True, slots=True)
class Program:
    """The file and the entry point of a node; "" without one."""

    path: Path
    entry: str = ""


def program(node: LaunchedNode, workspace: Workspace, files: Iterable[Path]) -> Program | str:
    """Return the program of a node, or the reason why there is none. `files` are the Python files of the workspace.

    If the package installs a script from a place where the script does not exist, the whole package is searched for
    the script, as `rosrun` does.
    """
    if node.kind == "test":
        return "a test"
    if node.kind != "node":
        return "a composable node" if node.kind == "component" else "a container of composable nodes"
    package = workspace.package(node.package)
    if package is None:
        return f"the package {node.package} is not in the workspace"
    declared = next((one for one in package.executables if one.name == node.executable), None)
    if declared is not None and declared.path is not None:
        return Program(declared.path, declared.entry or "")
    if declared is not None and declared.entry:
        return f"{declared.module} of {node.package}, in which {node.executable} begins, does not exist"
    named = [one for one in files if one.name == node.executable and one.is_relative_to(package.folder)]
    if named:  # rosrun searches the whole package for a file of this name
        return Program(min(named, key=lambda one: (len(one.parts), one)))
    return f"no Python program {node.executable} in {node.package}"
