"""Read a node's parameters and arguments from its workspace's launch files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros.launch_choice import chosen
from pytest_tarl.ros.launch_sources import NOTHING, Given, Source
from pytest_tarl.ros.messages.node_workspaces import on_forget, workspace_around
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.executables import is_python
from tarl_lint.workspace.folders import folders
from tarl_lint.workspace.launch_lookup import TEST
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_parameters import ON_ROBOT, Stated, leaves, stated
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.name_resolution import joined
from tarl_lint.workspace.node_programs import Program, program
from tarl_lint.workspace.parameter_yaml import NoYamlError
from tarl_lint.workspace.ros_arguments import plain

WITH_TEXTS: list[Callable[[], None]] = []  # functions that clear the caches of launch and parameter files


@cache
def given(script: Path, launch: Path | None = None) -> Given:
    """Return what the file `launch` gives a script or, without `launch`, what all the workspace's launch files give it.

    If these files differ, `launch_choice.chosen` decides. Raise SettingsError if the named file does not exist or does
    not start the script.
    """
    workspace = workspace_around(script)
    if workspace is None:
        return NOTHING
    if launch is None:
        starts = _starts(workspace, script)
    else:
        one = _read(launch, workspace)
        starts = [(one, node) for node in one.nodes if _runs(workspace, node, script)]
        if not starts:
            raise SettingsError(f"tarl.start: {launch} starts no node from {script.name}.")
    package = workspace.package_of(script)
    found = [(_given(one, node), one.file) for one, node in starts]
    got = chosen(script, None if package is None else package.folder, found)
    return replace(got, sources=tuple(_source(workspace, one, node) for one, node in starts))


def _starts(workspace: Workspace, script: Path) -> list[tuple[Launch, LaunchedNode]]:
    """Return the launch files that start a script, with the nodes in question.

    If a file needs launch arguments for the node, it is replaced by the files that include it with these arguments.
    """
    named = {one.name for package in workspace.packages for one in package.executables if one.path == script}
    direct = [
        (one, node)
        for one in _launches(workspace, sorted({script.name, *named}))
        for node in one.nodes
        if node.file == one.file and _runs(workspace, node, script)
    ]
    direct = [
        one for one in direct if one[0].file.suffix != TEST
    ] or direct  # launch files of tests count only if there are no others
    found = []
    for one, node in direct:
        files = () if _source(workspace, one, node).complete else _launches(workspace, [one.file.name])
        including = [
            (outer, inner)
            for outer in files
            for inner in outer.nodes
            if outer.file != one.file
            and (inner.file, inner.line) == (node.file, node.line)
            and _source(workspace, outer, inner).complete
        ]
        found += including or [(one, node)]
    return found


def _source(workspace: Workspace, launch: Launch, node: LaunchedNode) -> Source:
    """Return a launch file as the source of a node's settings."""
    package = workspace.package_of(launch.file)
    name = f"{package.name}/{launch.file.name}" if package is not None else launch.file.name
    own = node.name if node.name and "$(" not in node.name else node.executable
    got = _given(launch, node)
    argv = plain(node.arguments, for_ros2=launch.ros2)
    values = {**dict(leaves(got.shared)), **dict(leaves(got.private))}
    return Source(launch.file, name, own, argv, {**values, **got.private}, got.valueless, launch.required)


def _runs(workspace: Workspace, node: LaunchedNode, script: Path) -> bool:
    """Return whether a launch file's node runs the script."""
    package = workspace.package(node.package)
    if package is None:
        return False
    found = program(node, workspace, (*python_files(package.folder), script))
    return isinstance(found, Program) and found.path == script


@cache
def python_files(package: Path) -> tuple[Path, ...]:
    """Return the Python files below the folder of a package."""
    return tuple(
        one for folder, names in folders(package) for name in names if is_python(one := folder / name)
    )


def _given(launch: Launch, node: LaunchedNode) -> Given:
    """Return what a launch file gives a node, with parsed YAML, for a test that starts it in the namespace `/`."""
    found = parameters(launch, node, joined(node.namespace, node.name) if node.name else node.namespace + "/")
    argv = plain(node.arguments, for_ros2=launch.ros2)
    known = argv if not any("$(" in one for one in argv) else ()
    named = {_rooted(name, node): value for name, value in found.shared.items()}
    # in a group, `<rosparam ns="NODE">` sets the node's private parameters under their absolute names
    below = f"/{node.name}/" if node.name else "//"
    shared = {name: value for name, value in named.items() if not name.startswith(below)}
    private = {
        **{name.removeprefix(below): value for name, value in named.items() if name.startswith(below)},
        **{_rooted(name, node): value for name, value in found.private.items()},
    }
    valueless = tuple(_rooted(name, node).removeprefix(below) for name in found.valueless)
    note = found.note
    if known:
        note = note.replace(
            "parameters of", "parameters and arguments of" if private or shared else "arguments of", 1
        )
    return replace(found, shared=shared, private=private, valueless=valueless, argv=known, note=note)


def parameters(launch: Launch, node: LaunchedNode, full_name: str) -> Given:
    """Return the parameter values of a launched node, with parsed YAML."""
    private: dict[str, Any] = {}
    shared: dict[str, Any] = {}
    files: dict[Path, None] = {}
    valueless: dict[str, None] = {}
    for one in _stated((*launch.settings, *node.settings), full_name):
        if one.value is None or one.value is ON_ROBOT:
            valueless[one.name.removeprefix("~")] = None
        else:
            (private if one.name.startswith("~") else shared)[one.name.removeprefix("~")] = one.value
            files[one.file] = None
    sources = ", ".join(file.name for file in files if file != launch.file)
    note = f"parameters of {node.name or node.executable} come from {launch.file.name}"
    return Given(
        private, shared, f"{note} ({sources})." if sources else f"{note}.", valueless=tuple(valueless)
    )


def _rooted(name: str, node: LaunchedNode) -> str:
    """Move a name from the node's namespace to `/`, where the test starts the node."""
    inside = name.startswith(f"{node.namespace.rstrip('/')}/") and node.namespace != "/"
    return name.removeprefix(node.namespace.rstrip("/")) if inside else name


def _stated(settings: Sequence[Setting], full_name: str) -> Iterator[Stated]:
    for setting in settings:
        yield from _of_setting(setting, full_name)


def _of_setting(setting: Setting, full_name: str) -> Iterator[Stated]:
    try:
        yield from stated((setting,), full_name)
    except NoYamlError:
        raise SettingsError(
            f"{setting.file} has parameters of the node, and reading them needs PyYAML: run pip install "
            "PyYAML, or call tarl.start(…, launch=False)."
        ) from None
    except UnreadableError as reason:
        raise SettingsError(f"{setting.file}: {reason}") from None


def _launches(workspace: Workspace, names: Sequence[str]) -> list[Launch]:
    """Return the launch files that contain any of these names."""
    words = [name.encode() for name in names]
    files = [file for package in workspace.packages for file in package.launch_files]
    return [_read(file, workspace) for file in files if any(word in _bytes(file) for word in words)]


@cache
def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b""


def _read(file: Path, workspace: Workspace) -> Launch:
    if not file.is_file():
        raise SettingsError(f"tarl.start: there is no launch file {file}.")
    from tarl_lint.workspace.launch_read import read_launch

    return read_launch(file, workspace)


@contextmanager
def texts_replaced() -> Iterator[None]:
    """Clear the caches of launch and parameter files on entry and exit, because their texts differ in between."""
    for clear in WITH_TEXTS:
        clear()
    try:
        yield
    finally:
        for clear in WITH_TEXTS:
            clear()


WITH_TEXTS.append(given.cache_clear)
for known in (given, python_files, _bytes):
    on_forget(known.cache_clear)
