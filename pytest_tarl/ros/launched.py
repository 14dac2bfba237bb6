"""The parameters that the launch files of the workspace give a node, for tests that do not state them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from pytest_tarl.errors import SettingsError
from pytest_tarl.ros.messages.workspace import on_forget, workspaces
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.model import Workspace


@dataclass(frozen=True)
class Given:
    """Parameters from a launch file: `private` ones by name, `shared` ones by absolute name; `note` says whence."""

    private: Mapping[str, Any] = field(default_factory=dict)
    shared: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""


NOTHING = Given()


@cache
def given(script: Path, launch: Path | None = None) -> Given:
    """Return the parameters that a launch file gives a script: the file named, else the only one that gives any.

    Among several files that start the script with different parameters, those of its own package count. Raises
    SettingsError where the named file does not start it.
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
    """Return the parameters that all files agree on; else those that the files of the script's package agree on."""
    own = workspace.package_of(script)
    telling = [(one, file) for one, file in zip(found, files, strict=True) if one.private or one.shared]
    near = [(one, file) for one, file in telling if own is not None and file.is_relative_to(own.folder)]
    for some in (telling, near):
        if some and all(_same(one, some[0][0]) for one, _ in some):
            return some[0][0]
    if not telling:
        return NOTHING
    names = sorted({file.name for _, file in near or telling})
    shown = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    return Given(
        note=f"{script.name} is started with different parameters by launch files ({shown}), so it got none of them: "
        "name one with tarl.start(…, launch=FILE), or state parameters={…}."
    )


def _same(one: Given, other: Given) -> bool:
    return (one.private, one.shared) == (other.private, other.shared)


def _runs(workspace: Workspace, node: LaunchedNode, script: Path) -> bool:
    """Tell whether a node of a launch file runs a script."""
    package = workspace.package(node.package)
    if package is None:
        return False
    declared = next((one for one in package.executables if one.name == node.executable), None)
    if declared is not None:
        return declared.path == script
    return script.name == node.executable and script.is_relative_to(package.folder)


def _given(launch: Launch, node: LaunchedNode) -> Given:
    """Return the values of a node's parameters, YAML read."""
    private: dict[str, Any] = {}
    shared: dict[str, Any] = {}
    files: list[Path] = []
    for setting in (*launch.settings, *node.settings):
        values = {_rooted(name, node): value for name, value in _values(setting, node)}
        (private if setting.name.startswith("~") else shared).update(values)
        files += [setting.file] if values and setting.file not in files else []
    sources = ", ".join(file.name for file in files if file != launch.file)
    note = f"parameters of {node.name or node.executable} come from {launch.file.name}"
    return Given(private, shared, f"{note} ({sources})." if sources else f"{note}.")


def _rooted(name: str, node: LaunchedNode) -> str:
    """Return a name within the node's namespace as a name within `/`, where the test starts the node."""
    inside = name.startswith(f"{node.namespace.rstrip('/')}/") and node.namespace != "/"
    return name.removeprefix(node.namespace.rstrip("/")) if inside else name


def _values(setting: Setting, node: LaunchedNode) -> Iterator[tuple[str, Any]]:
    """Yield the parameters of a setting, by the name within the node or the absolute name."""
    above = setting.name.removeprefix("~").rstrip("/")
    if setting.yaml is None:
        yield above, setting.value
        return
    content = _yaml(setting)
    if not isinstance(content, dict):
        yield above, content
        return
    for name, value in _of_node(content, node).items():
        yield f"{above}/{name}" if above or not setting.name.startswith("~") else str(name), value


def _of_node(content: dict[Any, Any], node: LaunchedNode) -> dict[Any, Any]:
    """Return the part of a ROS 2 parameter file that is for a node; other content as it is."""
    parts = [
        (str(key).strip("/"), value["ros__parameters"])
        for key, value in content.items()
        if isinstance(value, dict) and isinstance(value.get("ros__parameters"), dict)
    ]
    if not parts:
        return content
    wanted = {"**", node.name, f"{node.namespace.strip('/')}/{node.name}".strip("/")}
    chosen: dict[Any, Any] = {}
    for key, value in parts:
        if key in wanted or (not node.name and len(parts) == 1):
            chosen.update(_flat(value))
    return chosen


def _flat(values: Mapping[Any, Any], above: str = "") -> dict[str, Any]:
    """Return nested parameters of ROS 2 by names with dots."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        name = f"{above}{key}"
        found.update(_flat(value, f"{name}.") if isinstance(value, dict) else {name: value})
    return found


def _yaml(setting: Setting) -> Any:
    try:
        import yaml
    except ModuleNotFoundError:
        raise SettingsError(
            f"{setting.file} has parameters of the node, and reading them needs PyYAML: run pip install PyYAML, or say "
            "tarl.start(…, launch=False)."
        ) from None
    try:
        return yaml.safe_load(setting.yaml or "")
    except yaml.YAMLError as problem:
        raise SettingsError(f"{setting.file} is not YAML: {' '.join(str(problem).split())}") from None


def _launches(workspace: Workspace, script: Path) -> tuple[Launch, ...]:
    """Return the launch files that may start a script: those with its name, or that of a program which it is."""
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


for known in (given, _bytes):
    on_forget(known.cache_clear)
