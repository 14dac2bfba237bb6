"""Read a node's parameters from the launch files of its workspace."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros.messages.workspace import on_forget, workspaces
from tarl_lint.workspace.bounded_files import UnreadableError
from tarl_lint.workspace.executables import is_python
from tarl_lint.workspace.folders import folders
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.launch_parameters import ON_ROBOT, Stated, stated
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.node_programs import Program, program
from tarl_lint.workspace.parameter_yaml import NoYamlError
from tarl_lint.workspace.ros_names import joined


@dataclass(frozen=True)
class Given:
    """Parameters from a launch file: `private` by name, `shared` by absolute name; `note` names the file.

    `node` is the absolute name of a node that `tarl.launch` starts; it is empty for one that `tarl.start` starts.
    `valueless` holds names of parameters without a usable value: either the value is only known at launch, or it is
    null in YAML, which ROS 1 cannot store.
    """

    private: Mapping[str, Any] = field(default_factory=dict)
    shared: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""
    node: str = ""
    valueless: tuple[str, ...] = ()


NOTHING = Given()
WITH_TEXTS: list[Callable[[], None]] = []  # functions that clear the caches of launch and parameter files


@cache
def given(script: Path, launch: Path | None = None) -> Given:
    """Return a script's parameters from the file `launch`; without it, from all launch files that start the script.

    If these files give different parameters, use only the files in the script's package; if those differ as well,
    return the parameters on which they agree, and a note.

    Raise SettingsError if the named file does not exist or does not start the script.
    """
    workspace = next((one for one in workspaces() if script.is_relative_to(one.root)), None)
    if workspace is None:
        return NOTHING
    launches = _launches(workspace, script) if launch is None else (_read(launch, workspace),)
    starts = [
        (one, node) for one in launches for node in one.nodes if node.file == one.file or launch is not None
    ]
    found = [(one, node) for one, node in starts if _runs(workspace, node, script)]
    if launch is not None and not found:
        raise SettingsError(f"tarl.start: {launch} starts no node from {script.name}.")
    return _chosen(
        workspace, script, [_given(one, node) for one, node in found], [one.file for one, _ in found]
    )


def _chosen(workspace: Workspace, script: Path, found: Sequence[Given], files: Sequence[Path]) -> Given:
    """Return the parameters if all files agree, or else those on which all files of the script's package agree."""
    own = workspace.package_of(script)
    telling = [(one, file) for one, file in zip(found, files, strict=True) if one.private or one.shared]
    near = [(one, file) for one, file in telling if own is not None and file.is_relative_to(own.folder)]
    for some in (telling, near):
        if some and all(_same(one, some[0][0]) for one, _ in some):
            return some[0][0]
    if not telling:
        return NOTHING
    differing = near or telling
    names = sorted({file.name for _, file in differing})
    shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    private = _agreed([one.private for one, _ in differing])
    shared = _agreed([one.shared for one, _ in differing])
    got = "only those that are equal in all of them" if private or shared else "none of them"
    note = (
        f"{script.name} is started with different parameters by launch files ({shown}), so it got {got}: "
        "name one with tarl.start(…, launch=FILE), or state parameters={…}."
    )
    valueless = {name: None for one, _ in differing for name in one.valueless}
    return Given(private, shared, note, valueless=tuple(valueless))


def _agreed(mappings: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the entries that are equal in all mappings; compare nested mappings entry by entry."""
    first, *others = mappings
    agreed: dict[str, Any] = {}
    for name, value in first.items():
        values = [other.get(name, NOTHING) for other in others]
        if all(_equal(value, other) for other in values):
            agreed[name] = value
        elif isinstance(value, Mapping) and all(isinstance(other, Mapping) for other in values):
            part = _agreed([value, *values])
            if part:
                agreed[name] = part
    return agreed


def _equal(one: Any, other: Any) -> bool:
    """Return whether two YAML values are identical; unlike in Python, 1, 1.0 and True differ."""
    return repr(one) == repr(other)


def _same(one: Given, other: Given) -> bool:
    return (one.private, one.shared) == (other.private, other.shared)


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
    """Return the values of a node's parameters, with YAML parsed, for a test that starts it in the namespace `/`."""
    found = parameters(launch, node, joined(node.namespace, node.name) if node.name else node.namespace + "/")
    shared = {_rooted(name, node): value for name, value in found.shared.items()}
    return replace(found, shared=shared, private={_rooted(k, node): v for k, v in found.private.items()})


def parameters(launch: Launch, node: LaunchedNode, full_name: str) -> Given:
    """Return the values of the parameters of a launched node, with YAML parsed."""
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
    """Move a name from the node's namespace to `/`, the namespace in which the test starts the node."""
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
            f"{setting.file} has parameters of the node, and reading them needs PyYAML: run pip install PyYAML, or "
            "say tarl.start(…, launch=False)."
        ) from None
    except UnreadableError as reason:
        raise SettingsError(f"{setting.file}: {reason}") from None


def _launches(workspace: Workspace, script: Path) -> tuple[Launch, ...]:
    """Return the launch files that contain the script's name or the name of its entry point."""
    named = {one.name for package in workspace.packages for one in package.executables if one.path == script}
    words = [name.encode() for name in sorted({script.name, *named})]
    files = [file for package in workspace.packages for file in package.launch_files]
    return tuple(_read(file, workspace) for file in files if any(word in _bytes(file) for word in words))


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
    """Clear the caches of launch and parameter files on entry and on exit, because the texts differ in the context."""
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
