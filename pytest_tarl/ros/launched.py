"""Read a node's parameters from the launch files of its workspace."""

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
    """Parameters from a launch file: `private` by name, `shared` by absolute name; `note` names the file."""

    private: Mapping[str, Any] = field(default_factory=dict)
    shared: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""


NOTHING = Given()
DEEPEST = 50  # levels of nested parameters; a YAML mapping may contain itself


@cache
def given(script: Path, launch: Path | None = None) -> Given:
    """Return a script's parameters from the named launch file, or else from the only one that sets any.

    If several files start the script with different parameters, only those of its own package count.

    Raises SettingsError if the named file does not exist or does not start the script.
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
    """Return the parameters if all files agree; else if all files of the script's package agree."""
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
    """Return whether a launch file's node runs the script."""
    package = workspace.package(node.package)
    if package is None:
        return False
    declared = next((one for one in package.executables if one.name == node.executable), None)
    if declared is not None:
        return declared.path == script
    return script.name == node.executable and script.is_relative_to(package.folder)


def _given(launch: Launch, node: LaunchedNode) -> Given:
    """Return the values of a node's parameters, with YAML parsed."""
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
    """Move a name from the node's namespace to `/`, the namespace in which the test starts the node."""
    inside = name.startswith(f"{node.namespace.rstrip('/')}/") and node.namespace != "/"
    return name.removeprefix(node.namespace.rstrip("/")) if inside else name


def _values(setting: Setting, node: LaunchedNode) -> Iterator[tuple[str, Any]]:
    """Yield the parameters of a setting, by private or absolute name."""
    above = setting.name.removeprefix("~").rstrip("/")
    if setting.yaml is None:
        yield above, setting.value
        return
    content = _yaml(setting)
    if not isinstance(content, dict):
        yield above, content
        return
    for name, value in _of_node(content, node).items():
        if "$(" in str(value):  # known on the robot only
            continue
        yield f"{above}/{name}" if above or not setting.name.startswith("~") else str(name), value


def _of_node(content: dict[Any, Any], node: LaunchedNode) -> dict[Any, Any]:
    """Return the section of a ROS 2 parameter file for a node; other content unchanged."""
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
    """Flatten nested ROS 2 parameters to dotted names."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        name = f"{above}{key}"
        nested = isinstance(value, dict) and name.count(".") < DEEPEST
        found.update(_flat(value, f"{name}.") if nested else {name: value})
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
    except (yaml.YAMLError, RecursionError) as problem:
        raise SettingsError(f"{setting.file} is not YAML: {' '.join(str(problem).split())}") from None


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


for known in (given, _bytes):
    on_forget(known.cache_clear)
