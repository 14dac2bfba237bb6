"""Read ROS 2 launch files in Python by interpreting their calls. Nothing is executed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace import launch_reads
from tarl_lint.workspace.launch_actions import Action, Condition, Quoted, gz_bridge
from tarl_lint.workspace.launch_branches import BranchingInterpreter
from tarl_lint.workspace.launch_values import (
    Anonymous,
    Choice,
    Comparison,
    Configuration,
    Content,
    Context,
    Expression,
    Here,
    Joined,
    Logic,
    OnRobot,
    Package,
)
from tarl_lint.workspace.model import Problem, Workspace
from tarl_lint.workspace.python.elements import bounded
from tarl_lint.workspace.python.evaluator import Unknown
from tarl_lint.workspace.python.objects import Function, Method
from tarl_lint.workspace.python.paths import FilePath
from tarl_lint.workspace.python.values import Partial

_ACTIONS: Final = {
    "launch.LaunchDescription": ("group", "actions"),
    "launch.actions.DeclareLaunchArgument": ("argument", "name"),
    "launch.actions.SetLaunchConfiguration": ("set", "name", "value"),
    "launch.actions.UnsetLaunchConfiguration": ("unset", "name"),
    "launch.actions.SetEnvironmentVariable": ("environment", "name", "value"),
    "launch.actions.UnsetEnvironmentVariable": ("unset environment", "name"),
    "launch.actions.PushLaunchConfigurations": ("push",),
    "launch.actions.PopLaunchConfigurations": ("pop",),
    "launch.actions.ResetLaunchConfigurations": ("reset", "launch_configurations"),
    "launch.actions.IncludeLaunchDescription": ("include", "source"),
    "launch_ros.actions.Node": ("node",),
    "launch_ros.actions.LifecycleNode": ("node",),
    "launch_ros.actions.ComposableNodeContainer": ("container",),
    "launch_ros.actions.LoadComposableNodes": ("load",),
    "launch_ros.descriptions.ComposableNode": ("component",),
    "launch_ros.actions.PushRosNamespace": ("namespace", "namespace"),
    "launch_ros.actions.PushROSNamespace": ("namespace", "namespace"),
    "launch_ros.actions.SetRemap": ("remap", "src", "dst"),
    "launch_ros.actions.SetParameter": ("parameter", "name", "value"),
    "launch_ros.actions.SetParametersFromFile": ("parameter file", "filename"),
    "launch_ros.parameter_descriptions.ParameterFile": ("parameters of a file", "param_file"),
    "launch_ros.descriptions.ParameterFile": ("parameters of a file", "param_file"),
}
_HOMES: Final = (
    "description",
    "substitution",
    "action",
)  # submodules of launch that re-export its names
_EVENTS: Final = ("on_exit", "on_start", "on_stdout", "on_stderr", "on_completion", "entities")


def module_file(path: Path, workspace: Workspace, name: str) -> Path | None:
    """Return the file of a module in the workspace or beside `path`."""
    first, *rest = name.split(".")
    homes = [one.path for each in workspace.packages for one in each.modules if one.name == first]
    beside = path.parent / first
    for home in (*homes, beside, beside.with_suffix(".py")):
        base = home.joinpath(*rest)
        for place in (base if home.suffix == ".py" else base.with_suffix(".py"), base / "__init__.py"):
            if place.is_file() and place.suffix == ".py" and place != path:
                return place
    return None


@dataclass(frozen=True)
class _Service:
    """`LaunchService`: a script includes launch descriptions in it and runs it."""

    included: list[Any]
    readable: ClassVar = frozenset({"include_launch_description"})

    def include_launch_description(self, description: Any) -> None:
        """Start a launch description."""
        self.included.append(description)


class _File:
    """The interpretation of one launch file."""

    def __init__(self, path: Path, workspace: Workspace) -> None:
        self.path, self.workspace = path, workspace
        self._included: list[Any] = []  # the descriptions that a LaunchService of the file includes
        self.file = BranchingInterpreter(
            path, self._models(), lambda name: module_file(path, workspace, name)
        )

    def actions(self, problems: list[Problem]) -> Any:
        """Return the launch description.

        Problems are added to `problems`, even later, when the returned functions are called.
        """
        self.file.problems = problems
        self.file.run()
        description = self.file.called("generate_launch_description")
        if isinstance(description, Action):
            return description
        if self._included:
            return self._included
        self.file.problem(0, "generate_launch_description returns nothing that can be followed")
        return ()

    def _models(self) -> dict[str, Any]:
        models: dict[str, Any] = {name: self._action(*made) for name, made in _ACTIONS.items()}
        models |= {
            "launch.LaunchService": lambda *_, **__: _Service(self._included),
            "launch.launch_service.LaunchService": lambda *_, **__: _Service(self._included),
            "launch.actions.GroupAction": self._group,
            "launch.actions.OpaqueFunction": self._opaque,
            "launch.actions.TimerAction": self._action("group", "period"),
            "launch_ros.actions.RosTimer": self._action("group", "period"),
            "launch.actions.RegisterEventHandler": self._handler,
            "ros_gz_bridge.actions.RosGzBridge": self._gz_bridge,
            **{f"launch.actions.{name}": self._action("other") for name in (
                "ExecuteProcess", "LogInfo", "AppendEnvironmentVariable", "EmitEvent", "Shutdown", "ExecuteLocal",
                "ResetEnvironment", "PushEnvironment",
                "PopEnvironment", "UnregisterEventHandler")},
            **{f"launch_ros.actions.{name}": self._action("other") for name in (
                "LifecycleTransition", "SetROSLogDir")},
            **{f"launch.event_handlers.{name}": self._action("event") for name in (
                "OnProcessExit", "OnProcessStart", "OnShutdown", "OnExecutionComplete")},
            "launch_ros.event_handlers.OnStateTransition": self._action("event"),
            "launch_ros.actions.SetUseSimTime": lambda value: self._action("parameter", "name", "value")(
                "use_sim_time", value),
            "launch.conditions.IfCondition": Condition,
            "launch.conditions.UnlessCondition": lambda value: Condition(value, wanted=False),
            "launch.conditions.LaunchConfigurationEquals": lambda name, value: Condition(value, name=name),
            "launch.conditions.LaunchConfigurationNotEquals": lambda name, value: Condition(
                value, wanted=False, name=name),
            **_substitutions(),
            **self._packages(),
            **launch_reads.models(self.workspace),
        }  # fmt: skip
        repeated = {}
        for name, model in models.items():
            first, second, *last = name.split(".")
            if last:
                snake = "".join(f"_{c.lower()}" if c.isupper() else c for c in last[0]).lstrip("_")
                repeated[f"{first}.{second}.{snake}.{last[0]}"] = model
        models["launch.launch_description.LaunchDescription"] = models["launch.LaunchDescription"]
        return repeated | models

    def _packages(self) -> dict[str, Any]:
        models: dict[str, Any] = {
            f"launch_ros.substitutions.{name}": lambda package: Package(package, self._folder)
            for name in ("FindPackageShare", "FindPackage")
        }
        for module in ("ament_index_python", "ament_index_python.packages"):
            models[f"{module}.get_package_share_directory"] = self._folder
            models[f"{module}.get_package_share_path"] = self._path
        models["launch_ros.substitutions.FindPackagePrefix"] = lambda name: OnRobot(f"find-pkg-prefix {name}")
        return models

    def _path(self, package: Any, *_: Any) -> Any:
        folder = self._folder(package)
        return FilePath(folder) if isinstance(folder, str) else folder

    def _action(self, kind: str, *names: str) -> Callable[..., Action]:
        def make(*values: Any, **keywords: Any) -> Action:
            given = {**dict(zip(names, values, strict=False)), **keywords}
            for old, new in (("node_executable", "executable"), ("node_name", "name"), ("node_plugin", "plugin"),
                             ("node_namespace", "namespace"), ("launch_arguments", "arguments"),
                             ("launch_description_source", "source"),
                             ("composable_node_descriptions", "components")):  # fmt: skip
                if old in given and (kind != "node" or old != "launch_arguments"):
                    given.setdefault(new, given.pop(old))
            # a copy: later actions of this group must not change the launch file's list
            if kind == "group":
                given["actions"] = list(given.get("actions") or given.get("initial_entities") or [])
            if self.file.condition:
                given["assumed"] = self.file.condition
            return Action(kind, self.file.line, given)

        return make

    def _group(self, actions: Any = (), **keywords: Any) -> Action:
        return self._action("group", "actions")(actions, **{"scoped": True, **keywords})

    def _handler(self, handler: Any = None, **keywords: Any) -> Action:
        """Return the actions of an event handler, which start when the event occurs."""
        handler = keywords.pop("event_handler", handler)
        values = handler.values if isinstance(handler, Action) else {}
        return self._action("group", "actions")(
            [values[key] for key in _EVENTS if key in values], **{"event": True, **keywords}
        )

    def _gz_bridge(self, **keywords: Any) -> Action:
        values = gz_bridge(self.file.line, keywords).values
        return self._action("node")(condition=keywords.get("condition"), **values)

    def _opaque(self, function: Any = None, **keywords: Any) -> Action:
        line, args, named = self.file.line, keywords.pop("args", None), keywords.pop("kwargs", None)

        def made(context: Context) -> Any:
            given = args if isinstance(args, list | tuple) else ()
            stated = named if isinstance(named, dict) else {}
            if not isinstance(function, Function | Method | Partial):
                return Unknown(line, "OpaqueFunction")
            return self.file.entered(function, [context, *given], dict(stated))

        return self._action("opaque")(made=made, **keywords)

    def _folder(self, package: Any, *_: Any) -> Any:
        known = self.workspace.package(package) if isinstance(package, str) else None
        return (
            str(known.folder) if known is not None else Unknown(self.file.line, f"find-pkg-share {package}")
        )


def _substitutions() -> dict[str, Any]:
    module = "launch.substitutions"
    sources = ("PythonLaunchDescriptionSource", "AnyLaunchDescriptionSource", "FrontendLaunchDescriptionSource",
               "XMLLaunchDescriptionSource", "YAMLLaunchDescriptionSource")  # fmt: skip
    homes = ("launch.launch_description_sources", "launch_xml.launch_description_sources",
             "launch_yaml.launch_description_sources")  # fmt: skip
    return {
        f"{module}.LaunchConfiguration": _configuration,
        f"{module}.TextSubstitution": lambda text="": text,
        f"{module}.PathJoinSubstitution": lambda parts: Joined(_parts(parts), "/"),
        f"{module}.PathSubstitution": lambda path: Joined(_parts(path), "/"),
        f"{module}.PythonExpression": lambda expression, *_, **__: Expression(_parts(expression)),
        f"{module}.ThisLaunchFileDir": Here,
        f"{module}.ThisLaunchFile": lambda: Here(whole=True),
        f"{module}.EnvironmentVariable": _environment,
        f"{module}.Command": lambda *_, **__: OnRobot("command"),
        f"{module}.FindExecutable": lambda *_, **__: OnRobot("find-exec"),
        f"{module}.AnonName": lambda name: Anonymous(_hashed(name)),
        f"{module}.EqualsSubstitution": Comparison,
        f"{module}.NotEqualsSubstitution": lambda left, right: Comparison(left, right, equal=False),
        f"{module}.NotSubstitution": lambda value: Logic("not", (value,)),
        f"{module}.AllSubstitution": lambda *values: Logic("and", values),
        f"{module}.AnySubstitution": lambda *values: Logic("or", values),
        f"{module}.FileContent": Content,
        f"{module}.AndSubstitution": lambda *values: Logic("and", values),
        f"{module}.OrSubstitution": lambda *values: Logic("or", values),
        f"{module}.IfElseSubstitution": _choice,
        "launch.utilities.perform_substitutions": lambda context, value: context.perform_substitution(value),
        "launch.utilities.normalize_to_list_of_substitutions": lambda value: value,
        "nav2_common.launch.LaunchConfigAsBool": _as_bool,
        "nav2_common.launch.RewrittenYaml": _rewritten,
        "launch_ros.parameter_descriptions.ParameterValue": _value,
        "launch_ros.descriptions.ParameterValue": _value,
        "launch_ros.parameter_descriptions.Parameter": _named_value,
        "launch_ros.descriptions.Parameter": _named_value,
        **{f"{home}.{name}": lambda location, **_: location for home in homes for name in sources},
    }


def _configuration(variable_name: Any, *, default: Any = None, **_: Any) -> Configuration:
    return Configuration(_hashed(variable_name), _hashed(default))


def _as_bool(name: Any) -> Choice:
    """Return the substitution of Navigation 2 for a boolean launch argument."""
    return Choice(Configuration(_hashed(name)), "True", "False")


def _rewritten(source_file: Any, param_rewrites: Any = None, **_: Any) -> Any:
    """Return a parameter file of Navigation 2; Unknown if values in it are replaced."""
    return source_file if not param_rewrites else Unknown(0, "RewrittenYaml")


def _environment(name: Any, default_value: Any = None, **_: Any) -> OnRobot:
    return OnRobot(f"env {name}" if isinstance(name, str) else "env", _hashed(default_value))


def _choice(condition: Any, if_value: Any = "", else_value: Any = "") -> Choice:
    return Choice(_hashed(condition), _hashed(if_value), _hashed(else_value))


def _value(value: Any, value_type: Any = None, **_: Any) -> Quoted:
    return Quoted(value, "str" if value_type is str else "")


def _named_value(name: Any, value: Any, value_type: Any = None, **_: Any) -> dict[Any, Quoted]:
    """Return a parameter with its name, as in the dicts of a node's parameters."""
    return {_hashed(name): _value(value, value_type)}


def _parts(value: Any) -> tuple[Any, ...]:
    whole = _hashed(value)
    return whole if isinstance(whole, tuple) else (whole,)


def _hashed(value: Any) -> Any:
    """Return a hashable form of a value. Raises ValueError if it has too many elements."""
    if not bounded(value):
        raise ValueError("too many values")
    return _tuples(value)


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list | tuple) else value


def actions_of_python(path: Path, workspace: Workspace, problems: list[Problem]) -> Any:
    """Return the actions of a launch file in Python."""
    return _File(path, workspace).actions(problems)
