"""Read a launch file: Python nodes with names, command lines and parameters, and other nodes."""

from __future__ import annotations

import ast
import difflib
import re
import shlex
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import combinations
from pathlib import Path

from pytest_tarl.errors import SettingsError
from pytest_tarl.files import existing
from pytest_tarl.ros.launch_sources import Given
from pytest_tarl.ros.launched import WITH_TEXTS, parameters, python_files
from pytest_tarl.ros.messages.node_workspaces import on_forget, prefer, search, workspace_around
from tarl_lint.node_names import node_name
from tarl_lint.workspace.conditions import exclusive
from tarl_lint.workspace.folders import has_packages, workspace_root
from tarl_lint.workspace.hidden_packages import problems as hidden
from tarl_lint.workspace.launch_lookup import NoLaunchFileError, launch_file, unknown_argument
from tarl_lint.workspace.launch_model import Launch, LaunchedNode
from tarl_lint.workspace.launch_read import read_launch
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.name_resolution import joined, remapped
from tarl_lint.workspace.node_programs import Program, program

SHOWN = 3  # maximum number of problems in one note on a launch file
_ARGUMENT = re.compile(r"\$\((?:var|arg) ([\w-]+)\)")


@dataclass(frozen=True)
class Launched:
    """A node of a launch file. `path` is its Python program; if it is not Python, `foreign` says why.

    `problem` says why the node cannot be started; it is empty if it can be.
    """

    launch: Launch
    node: LaunchedNode
    name: str  # absolute
    path: Path | None = None
    entry: str | None = None
    foreign: str = ""
    argv: tuple[str, ...] = ()
    problem: str = ""

    @cached_property
    def given(self) -> Given:
        """Return the parameters. Raise SettingsError if the YAML cannot be read."""
        return replace(parameters(self.launch, self.node, self.name), node=self.name)

    @property
    def spellings(self) -> frozenset[str]:
        """Return the names by which a test may refer to the node."""
        node = self.node
        return frozenset(
            {self.name, self.name.strip("/"), self.name.rpartition("/")[2], node.executable,
             f"{node.package}/{node.executable}"}
        )  # fmt: skip

    def resolve(self, name: str) -> str:
        """Return a topic, service or parameter name, after the launch file's namespace and remappings."""
        return remapped(name, self.node.namespace, self.name.rpartition("/")[2], self.node.remaps)


@dataclass(frozen=True)
class LaunchPlan:
    """The nodes of a launch file in starting order, with notes for the user."""

    file: Path
    nodes: tuple[Launched, ...]
    notes: tuple[str, ...] = ()

    def chosen(self, only: Collection[str] | None, replaced: Collection[str]) -> tuple[Launched, ...]:
        """Return the nodes to start or replace; nodes in `replaced` need not be in `only`.

        Raise SettingsError for an unknown name, for a node in `only` that can be neither started nor replaced, and for
        two nodes that are never launched together.
        """
        for argument, names in (("only", only or ()), ("replace", replaced)):
            for name in names:
                self._check(argument, name)
        wanted = [one for one in self.nodes if only is None or named(one, (*only, *replaced))]
        if only is not None and not wanted:
            raise SettingsError(
                f"tarl.launch: only=[] leaves no node of {self.file.name} to start: leave it out to start all."
            )
        for one in wanted:
            if named(one, replaced):
                continue
            if one.problem:
                raise SettingsError(one.problem)
            if only is not None and one.foreign:
                raise SettingsError(
                    f"tarl.launch: only names {one.name}, which is not a Python node of the workspace ({one.foreign}). "
                    f'Replace it by a function of the test: replace={{"{one.name.rpartition("/")[2]}": function}}.'
                )
        _check_alternatives([one for one in wanted if not one.foreign or named(one, replaced)])
        return tuple(wanted)

    def _check(self, argument: str, name: str) -> None:
        if any(name in one.spellings for one in self.nodes):
            return
        known = [one.name for one in self.nodes]
        short = [one.rpartition("/")[2] for one in known]
        close = difflib.get_close_matches(name.rpartition("/")[2], short, 1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        raise SettingsError(
            f"tarl.launch: {argument} names {name!r}, but {self.file.name} starts no such node.{hint} It starts "
            f"{', '.join(known)}."
        )


def _check_alternatives(nodes: Sequence[Launched]) -> None:
    """Raise SettingsError if two nodes exclude each other by `if` and `unless` with the same argument."""
    for one, other in combinations(nodes, 2):
        if exclusive(one.node, other.node):
            argument = _ARGUMENT.search(one.node.condition)
            known = argument is not None and argument[1] in one.launch.arguments
            given = f'pass arguments={{"{argument[1]}": …}}, or ' if argument is not None and known else ""
            raise SettingsError(
                f"tarl.launch: {one.launch.file.name} starts either {one.name} ({one.node.condition}) or {other.name} "
                f"({other.node.condition}): {given}choose one of them with only=[…]."
            )


def named(one: Launched, names: Iterable[str]) -> bool:
    """Return whether the node has one of these names."""
    return not one.spellings.isdisjoint(names)


def launch_path(file: str, folder: Path, where: str = "tarl.launch") -> Path:
    """Return the path of a launch file, given relative to `folder` or by its name in the workspace around it.

    Raise SettingsError, with a message that begins with `where`, if there is no such file.
    """
    path = existing(folder, file)
    if path is not None and path.is_file():
        return path
    root = workspace_root(folder.resolve())
    if root is None and has_packages(folder):
        # the packages are beside the test, as in examples/workspace outside a repository
        root = folder.resolve()
        prefer(root)
    elif root is None:
        raise SettingsError(f"{where}: {file}: no such file in {folder}, which is not in a ROS workspace.")
    else:
        search(folder)
    try:
        return launch_file(file, workspace_around(folder.resolve()) or Workspace(root), str(root))
    except NoLaunchFileError as problem:
        raise SettingsError(f"{where}: {problem}") from None


def launch_plan(file: Path, arguments: Mapping[str, object]) -> LaunchPlan:
    """Return the plan of a launch file for these launch arguments.

    Raise SettingsError if an argument is unknown, or if the file starts nothing.
    """
    search(file.parent)
    return _plan(file, tuple(sorted((str(name), _text(value)) for name, value in arguments.items())))


def programs(plan: LaunchPlan) -> tuple[Path, ...]:
    """Return the files of the Python nodes, without duplicates."""
    return tuple(dict.fromkeys(one.path for one in plan.nodes if one.path is not None))


@lru_cache(maxsize=64)
def _plan(file: Path, arguments: tuple[tuple[str, str], ...]) -> LaunchPlan:
    workspace = workspace_around(file) or Workspace(file.parent)
    launch = read_launch(file, workspace, dict(arguments))
    _check_arguments(launch, [name for name, _ in arguments])
    nodes = [one for one in launch.nodes if one.kind != "test"]
    if not nodes:
        # a part of the file that could not be evaluated explains it best
        reasons = [one.reason for one in sorted(launch.problems, key=lambda one: not one.hides)]
        why = f": {reasons[0]}" if reasons else " with these arguments"
        raise SettingsError(f"tarl.launch: {file.name} starts no node{why}.")
    return LaunchPlan(
        file,
        tuple(_launched(launch, one, workspace) for one in nodes),
        tuple(_notes(launch, workspace)),
    )


def _text(value: object) -> str:
    """Return an argument as typed for `ros2 launch`."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _check_arguments(launch: Launch, names: Iterable[str]) -> None:
    problem = unknown_argument(launch, names)
    if problem:
        raise SettingsError(f"tarl.launch: {problem}")


def _launched(launch: Launch, node: LaunchedNode, workspace: Workspace) -> Launched:
    package = workspace.package(node.package)
    found = program(node, workspace, python_files(package.folder) if package is not None else ())
    own = node.name or (_name_in_code(found.path) if isinstance(found, Program) else "")
    name = joined(node.namespace, own or node.executable.rpartition("::")[2])
    problem = _symbolic(node, name, launch.arguments)
    if not isinstance(found, Program):
        return Launched(launch, node, name, foreign=found, problem=problem)
    argv = tuple(_command_line(node, ros2=launch.ros2))
    return Launched(launch, node, name, found.path, found.entry or None, "", argv, problem)


def _name_in_code(path: Path) -> str:
    try:
        return node_name(ast.parse(path.read_bytes()))
    except (OSError, SyntaxError, ValueError):
        return ""  # running the file will report the error


def _command_line(node: LaunchedNode, *, ros2: bool) -> Iterator[str]:
    """Yield a node's arguments, as roslaunch and ros2 launch pass them, without its parameters."""
    try:
        yield from shlex.split(node.arguments)
    except ValueError:
        yield from node.arguments.split()
    renames = [
        *([("__node" if ros2 else "__name", node.name)] if node.name else []),
        ("__ns", node.namespace),
    ]
    pairs = [f"{old}:={new}" for old, new in (*renames, *node.remaps)]
    if ros2:
        yield "--ros-args"
    for pair in pairs:
        yield from ("-r", pair) if ros2 else (pair,)


def _symbolic(node: LaunchedNode, name: str, arguments: Collection[str]) -> str:
    """Return why a node cannot be started if its description needs the robot, or an empty text."""
    remaps = [side for pair in node.remaps for side in pair]
    texts = [node.package, node.executable, node.name, node.namespace, node.arguments, *remaps]
    unknown = next((text for text in texts if "$(" in text), None)
    if unknown is None:
        return ""
    argument = _ARGUMENT.search(unknown)
    advice = (
        f'pass arguments={{"{argument[1]}": …}}'
        if argument and argument[1] in arguments
        else "leave it out with only=[…], or replace it by a function of the test with replace={…}"
    )
    return (
        f"tarl.launch: the node {name} ({node.file.name}:{node.line}) depends on {unknown!r}, which has no value "
        f"here: {advice}."
    )


def _notes(launch: Launch, workspace: Workspace) -> Iterator[str]:
    """Yield a note if parts of the launch file could not be evaluated."""
    problems = [f"{one.file.name}:{one.line}: {one.reason}" for one in launch.problems]
    problems += [f"{one.file.parent.name}/{one.file.name}: {one.reason}" for one in hidden(launch, workspace)]
    if problems:
        more = f"; and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        yield f"parts of {launch.file.name} could not be evaluated: {'; '.join(problems[:SHOWN])}{more}."
    twice = _names_of_several(launch.nodes)
    if twice:
        effect = (
            "in ROS 2 they share parameters and services" if launch.ros2 else "roslaunch refuses the file"
        )
        yield f"{launch.file.name} starts several nodes named {', '.join(twice[:SHOWN])}: {effect}."


def _names_of_several(nodes: Sequence[LaunchedNode]) -> list[str]:
    """Return the names shared by several nodes that may be launched together."""
    found: dict[tuple[str, str], list[LaunchedNode]] = {}
    for one in nodes:
        if one.name:
            found.setdefault((joined(one.namespace, one.name), one.anonymous), []).append(one)
    return [
        name
        for (name, _), named in found.items()
        if "$(" not in name and any(not exclusive(one, other) for one, other in combinations(named, 2))
    ]


on_forget(_plan.cache_clear)
WITH_TEXTS.append(_plan.cache_clear)
