"""Read ROS 2 launch files in Python by interpreting their calls: nodes with names, remappings and parameters.

Nothing is executed. Substitutions whose value is constant are replaced; launch arguments have their defaults.
"""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace.expressions import Library, Unknown
from tarl_lint.workspace.launch_model import Launch, LaunchedNode, Setting
from tarl_lint.workspace.model import Workspace
from tarl_lint.workspace.statements import Interpreter

LARGEST: Final = 1_000_000  # bytes of a YAML file
_NODES: Final = ("launch_ros.actions.Node", "launch_ros.actions.LifecycleNode")


@dataclass(frozen=True)
class _Argument:
    """`LaunchConfiguration(name)`."""

    name: str
    default: Any = None


@dataclass(frozen=True)
class _Joined:
    """A text from parts: a list of substitutions, or a path."""

    parts: tuple[Any, ...]
    between: str = ""


@dataclass(frozen=True)
class _Action:
    """A node, group, declaration or namespace; `line` is that of its call."""

    kind: str
    line: int
    values: dict[str, Any] = field(default_factory=dict)
    readable: frozenset[str] = frozenset({"add_action"})

    def add_action(self, action: Any) -> None:
        """Add to a launch description or group."""
        self.values.setdefault("actions", []).append(action)


@dataclass
class _Place:
    namespace: str = "/"
    arguments: dict[str, Any] = field(default_factory=dict)
    remaps: tuple[tuple[str, str], ...] = ()


class _Reader:
    """Interprets one file and goes through its launch description."""

    def __init__(self, path: Path, workspace: Workspace) -> None:
        self.path, self.workspace = path, workspace
        self.nodes: list[LaunchedNode] = []
        self.file = Interpreter(path, self._models())

    def read(self) -> Launch:
        """Return what the file starts."""
        self.file.run()
        description = self.file.called("generate_launch_description")
        if isinstance(description, _Action):
            self._actions(description.values.get("actions"), _Place())
        else:
            self.file.problem(0, "generate_launch_description returns nothing that can be followed")
        return Launch(self.path, tuple(self.nodes), (), tuple(self.file.problems))

    def _models(self) -> dict[str, Any]:
        models: dict[str, Any] = {name: self._action("node") for name in _NODES}
        models |= {
            "launch.LaunchDescription": self._action("group", "actions"),
            "launch.launch_description.LaunchDescription": self._action("group", "actions"),
            "launch.actions.GroupAction": self._action("group", "actions"),
            "launch.actions.DeclareLaunchArgument": self._action("argument", "name"),
            "launch.actions.SetLaunchConfiguration": self._action("set", "name", "value"),
            "launch_ros.actions.PushRosNamespace": self._action("namespace", "namespace"),
            "launch_ros.actions.SetRemap": self._action("remap", "src", "dst"),
            "launch.substitutions.LaunchConfiguration": _argument,
            "launch.substitutions.TextSubstitution": lambda text="": text,
            "launch.substitutions.PathJoinSubstitution": lambda parts: _Joined(tuple(parts), "/"),
            "launch_ros.substitutions.FindPackageShare": self._folder,
            "launch_ros.substitutions.FindPackage": self._folder,
            "launch_ros.parameter_descriptions.ParameterValue": lambda value, **_: value,
            "launch_ros.descriptions.ParameterValue": lambda value, **_: value,
            "launch_ros.parameter_descriptions.ParameterFile": lambda param_file, **_: param_file,
            "launch.substitutions.ThisLaunchFileDir": lambda: str(self.path.parent),
            "ament_index_python.packages.get_package_share_directory": self._folder,
            "ament_index_python.get_package_share_directory": self._folder,
        }
        module = "launch.substitutions"
        return models | {
            f"{module}.launch_configuration.LaunchConfiguration": models[f"{module}.LaunchConfiguration"]
        }

    def _action(self, kind: str, *names: str) -> Callable[..., _Action]:
        def make(*values: Any, **keywords: Any) -> _Action:
            return _Action(kind, self.file.line, {**dict(zip(names, values, strict=False)), **keywords})

        return make

    def _folder(self, package: Any, *_: Any) -> Any:
        known = self.workspace.package(package) if isinstance(package, str) else None
        return str(known.folder) if known is not None else Unknown(self.file.line, f"the folder of {package}")

    def _actions(self, actions: Any, place: _Place) -> None:
        for action in actions if isinstance(actions, list | tuple) else ():
            if isinstance(action, list | tuple):
                self._actions(action, place)
            elif isinstance(action, _Action):
                self._one(action, place)
            elif isinstance(action, Unknown):
                self.file.problem(action.line, f"`{action.text}` is not followed")

    def _one(self, action: _Action, place: _Place) -> None:
        values = action.values
        if action.kind == "argument":
            place.arguments.setdefault(str(values.get("name")), values.get("default_value"))
        elif action.kind == "set":
            place.arguments[str(values.get("name"))] = values.get("value")
        elif action.kind == "group":
            self._actions(values.get("actions"), replace(place, arguments=dict(place.arguments)))
        elif action.kind == "namespace":
            place.namespace = _joined(place.namespace, _text(values.get("namespace"), place) or "")
        elif action.kind == "remap":
            place.remaps = (*place.remaps, *_pairs([(values.get("src"), values.get("dst"))], place))
        elif action.kind == "node":
            self._node(action, place)

    def _node(self, action: _Action, place: _Place) -> None:
        values = action.values
        found = {key: _text(values.get(key), place) for key in ("package", "executable", "name", "namespace")}
        package, executable = (
            found["package"],
            found["executable"] or _text(values.get("node_executable"), place),
        )
        if package is None or executable is None:
            self.file.problem(action.line, "package or executable of a node is not constant")
            return
        node = LaunchedNode(
            package,
            executable,
            found["name"] or _text(values.get("node_name"), place) or "",
            _joined(place.namespace, found["namespace"] or ""),
            self.path,
            action.line,
            (*place.remaps, *_pairs(values.get("remappings"), place)),
            tuple(self._settings(values.get("parameters"), place, action.line)),
        )
        self.nodes.append(node)

    def _settings(self, parameters: Any, place: _Place, line: int) -> Iterator[Setting]:
        for one in parameters if isinstance(parameters, list | tuple) else ():
            if isinstance(one, dict):
                yield from self._stated(one, place, line, "")
                continue
            name = _text(one, place)
            path = Path(name) if name is not None else None
            if path is None or not path.is_file() or path.stat().st_size > LARGEST:
                self.file.problem(line, f"the parameter file {name or 'of a node'} is not known here")
                continue
            yield Setting("~", path, yaml=path.read_text("utf-8", errors="replace"))

    def _stated(self, values: Mapping[Any, Any], place: _Place, line: int, above: str) -> Iterator[Setting]:
        for key, value in values.items():
            name = _text(key, place)
            if name is None:
                continue
            if isinstance(value, dict):
                yield from self._stated(value, place, line, f"{above}{name}.")
                continue
            plain = _plain(value, place)
            if plain is None:
                self.file.problem(line, f"the parameter {above}{name} is not constant")
            elif isinstance(plain, str) and not isinstance(value, str):
                yield Setting(
                    f"~{above}{name}", self.path, yaml=plain
                )  # ROS 2 reads what arguments say as YAML
            elif isinstance(plain, list):
                yield Setting(f"~{above}{name}", self.path, yaml=repr(plain))
            else:
                yield Setting(f"~{above}{name}", self.path, plain)


def _argument(name: Any, *_: Any, default: Any = None, **__: Any) -> Any:
    return _Argument(name, default) if isinstance(name, str) else Unknown(0, "a launch argument")


def _text(value: Any, place: _Place) -> str | None:
    """Return the text of a value with its substitutions, None where it is not constant."""
    if isinstance(value, str):
        return value
    if isinstance(value, _Argument):
        inner = place.arguments.get(value.name, value.default)
        others = {
            key: one for key, one in place.arguments.items() if key != value.name
        }  # one may name itself
        return _text(inner if inner != value else value.default, replace(place, arguments=others))
    if isinstance(value, _Joined | list | tuple):
        parts = value.parts if isinstance(value, _Joined) else tuple(value)
        texts = [_text(part, place) for part in parts]
        known = [one for one in texts if one is not None]
        if len(known) < len(texts):
            return None
        return (
            posixpath.join(*known)
            if isinstance(value, _Joined) and value.between and known
            else "".join(known)
        )
    return None


def _plain(value: Any, place: _Place) -> Any:
    """Return a constant parameter value, None where it is none."""
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple) and all(isinstance(one, bool | int | float) for one in value):
        return list(value)
    if isinstance(value, list) and len(value) > 1 and all(isinstance(one, str) for one in value):
        return list(value)
    return None if isinstance(value, Unknown | Library) else _text(value, place)


def _pairs(remaps: Any, place: _Place) -> Iterator[tuple[str, str]]:
    for one in remaps if isinstance(remaps, list | tuple) else ():
        if isinstance(one, tuple | list) and len(one) == 2:
            old, new = _text(one[0], place), _text(one[1], place)
            if old is not None and new is not None:
                yield old, new


def _joined(namespace: str, name: str) -> str:
    whole = name if name.startswith("/") else f"{namespace}/{name}"
    return "/" + "/".join(part for part in whole.split("/") if part)


def read_python(path: Path, workspace: Workspace) -> Launch:
    """Return what a ROS 2 launch file in Python starts, with the defaults of its arguments."""
    return _Reader(path, workspace).read()
