"""Interpret the actions of a ROS 2 launch file: nodes with names, remappings and parameters.

The actions come from Python, XML or YAML. None of them is executed.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, ItemsView, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Final

from tarl_lint.workspace import ros_arguments
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.expressions import Library, Unknown
from tarl_lint.workspace.launch_model import Kind, LaunchedNode, Setting
from tarl_lint.workspace.launch_values import (
    Anonymous,
    Context,
    Joined,
    Substitution,
    performed,
    symbolic,
    truth,
)
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.python_values import FilePath
from tarl_lint.workspace.ros_arguments import first_of_each
from tarl_lint.workspace.ros_names import joined

LARGEST: Final = 1_000_000  # maximum size of a YAML file (bytes)
DEEPEST: Final = 20  # maximum nesting of includes
MOST: Final = 5_000  # maximum number of actions of a launch file with its includes


@dataclass(frozen=True)
class Action:
    """A node, group, declaration or include; `line` is the line of its call or element."""

    kind: str
    line: int
    values: dict[str, Any] = field(default_factory=dict)
    readable: frozenset[str] = frozenset({"add_action", "add_entity", "entities"})

    def add_action(self, action: Any) -> None:
        """Add to a launch description or group."""
        self.entities.append(action)

    add_entity = add_action

    @property
    def entities(self) -> Any:
        """Return the actions of a launch description or group."""
        return self.values.setdefault("actions", [])


@dataclass(frozen=True)
class Condition:
    """`IfCondition` and `UnlessCondition`; with `name`, a comparison of a launch configuration."""

    value: Any
    wanted: bool = True
    name: Any = None
    readable: ClassVar = frozenset({"evaluate"})

    def evaluate(self, context: Any) -> Any:
        """Return whether the condition holds, for the function of an OpaqueFunction; Unknown if that is unknown."""
        holds = truth(performed(self.value, context)) if self.name is None else None
        return Unknown(0, "a condition") if holds is None else holds is self.wanted


@dataclass(frozen=True)
class Quoted:
    """A parameter value with its type: `str` keeps a text unchanged, other types parse it as YAML."""

    value: Any
    kind: str = ""


Opener = Callable[[Path, Context, list[Problem]], Any]  # function that returns the actions of a launch file


@dataclass
class Runner:
    """Interprets actions and collects nodes. `opened` reads an included launch file."""

    opened: Opener
    nodes: list[LaunchedNode] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    arguments: set[str] = field(default_factory=set)  # names of the declared arguments
    required: set[str] = field(default_factory=set)  # names of the declared arguments without a value
    # the files that include the current action, with their arguments
    including: list[object] = field(default_factory=list)
    seen: int = 0
    # names of the arguments that are declared under a condition and have no value
    unsure: set[str] = field(default_factory=set)
    events: int = 0  # number of event handlers that contain the current action

    def run(self, actions: Any, context: Context, condition: str = "") -> None:
        """Interpret actions in order; `condition` is an enclosing condition known only on the robot."""
        for action in actions if isinstance(actions, list | tuple) else (actions,):
            self.seen += 1
            if self.seen > MOST:
                return
            if isinstance(action, list | tuple):
                self.run(action, context, condition)
            elif isinstance(action, Action):
                holds, unsure = self._holds(action, context)
                if holds:
                    own = combined(action.values.get("assumed", ""), unsure)
                    self._one(action, context, combined(condition, own))
            elif isinstance(action, Unknown):
                self._problem(context, action.line, f"`{action.text}` is not followed")

    def _holds(self, action: Action, context: Context) -> tuple[bool, str]:
        """Return whether an action is kept. If its condition is known only on the robot, also return the condition."""
        condition = action.values.get("condition")
        if condition is None:
            return True, ""
        if not isinstance(condition, Condition):
            text = performed(condition, context)
        elif condition.name is not None:
            left = context.configurations.get(performed(condition.name, context), "")
            right = performed(condition.value, context)
            if not symbolic(left) and not symbolic(right):
                return (left == right) is condition.wanted, ""
            text = f"{left} {'==' if condition.wanted else '!='} {right}"
        else:
            tested = performed(condition.value, context)
            holds = truth(tested)
            if holds is not None:
                return holds is condition.wanted, ""
            text = tested if condition.wanted else f"not {tested}"
        self._problem(context, action.line, f"the condition `{text}` is known on the robot only")
        return True, text

    def _one(self, action: Action, context: Context, condition: str) -> None:
        values = action.values
        if action.kind == "group":
            scoped = values.get("scoped", False) is not False
            inner = context.inside() if scoped else context
            for name, value in _items(values.get("launch_configurations")):
                inner.configurations[performed(name, context)] = performed(value, context)
            self.events += bool(values.get("event"))
            self.run(values.get("actions"), inner, condition)
            self.events -= bool(values.get("event"))
        elif action.kind in ("node", "container"):
            self._node(action, context, condition)
        elif action.kind == "load":
            self._components(values.get("components"), context, condition)
        elif action.kind == "include":
            self._include(action, context, condition)
        elif action.kind == "opaque":
            made = values["made"](context)
            self.run(made if made is not None else [], context, condition)
        elif action.kind == "unread":
            self._problem(context, action.line, str(values.get("reason")))
        else:
            self._set(action, context, condition)

    def _set(self, action: Action, context: Context, condition: str) -> None:
        """Apply an action that changes the context of later actions; what it sets on a condition is symbolic."""
        values, kind = action.values, action.kind
        name = performed(values.get("name"), context)

        def text(key: str) -> str:
            found = performed(values.get(key), context)
            return f"$({found} if {condition})" if condition else found

        if kind == "argument":
            self._declare(name, values.get("default_value"), context, condition)
        elif kind == "set":
            value = performed(values.get("value"), context)
            same = not condition or context.configurations.get(name) == value
            context.configurations[name] = value if same else f"$(var {name})"
        elif kind == "unset":
            context.configurations.pop(name, None)
        elif kind == "namespace":
            context.namespace = joined(context.namespace, text("namespace"))
        elif kind == "remap":
            pair = performed(values.get("src"), context), text("dst")
            context.remaps = (*context.remaps, pair)
        elif kind == "parameter":
            stated = {values.get("name"): values.get("value")}
            given = self._stated(stated, context, action.line, "")
            if condition:
                given = (Setting(one.name, one.file, unknown=True) for one in given)
            context.settings = (*context.settings, *given)
        elif kind == "parameter file":
            given = self._settings([values.get("filename")], context, action.line)
            context.settings = (*context.settings, *given)

    def _declare(self, name: str, default: Any, context: Context, condition: str) -> None:
        """Declare an argument. Its default is unknown if different conditions give it different defaults."""
        self.arguments.add(name)
        text = f"$(var {name})" if default is None else performed(default, context)
        if name not in context.configurations:
            self.required |= {name} if default is None else set()
            context.configurations[name] = text
            if condition:
                self.unsure.add(name)
        elif name in self.unsure and text != context.configurations[name]:
            context.configurations[name] = f"$(var {name})"

    def _include(self, action: Action, context: Context, condition: str) -> None:
        name = performed(action.values.get("source"), context)
        if symbolic(name) or not name:
            self._problem(context, action.line, f"the included file {name or '?'} is not in the workspace")
            return
        for key, value in _items(action.values.get("arguments")):
            context.configurations[performed(key, context)] = performed(value, context)
        here = (Path(name), frozenset(context.configurations.items()))
        if here in self.including or len(self.including) >= DEEPEST:
            said = "it includes itself" if here in self.including else "files include each other"
            self._problem(context, action.line, f"{Path(name).name}: {said}")
            return
        before, context.file = context.file, Path(name)
        self.including.append(here)
        try:
            actions = self.opened(context.file, context, self.problems)
            self.run(actions, context, condition)
        finally:
            self.including.pop()
            context.file = before

    def _node(self, action: Action, context: Context, condition: str) -> None:
        values = action.values
        kind: Kind = "container" if action.kind == "container" else "node"
        if not values.get("package") and kind == "node" and not values.get("executable"):
            self._problem(context, action.line, "a node has neither package nor executable")
            return
        self._started(values, context, action.line, kind, condition)
        self._components(values.get("components"), context, condition)

    def _components(self, components: Any, context: Context, condition: str) -> None:
        """Add the composable nodes of a container."""
        for one in components if isinstance(components, list | tuple) else ():
            if isinstance(one, Action) and one.kind == "component":
                holds, unsure = self._holds(one, context)
                if holds:
                    values = {**one.values, "executable": one.values.get("plugin")}
                    own = combined(one.values.get("assumed", ""), unsure)
                    self._started(values, context, one.line, "component", combined(condition, own))
            elif isinstance(one, Unknown):
                self._problem(context, one.line, f"`{one.text}` is not followed")

    def _started(
        self, values: Mapping[str, Any], context: Context, line: int, kind: Kind, condition: str
    ) -> None:
        found = {key: performed(values.get(key), context) for key in ("package", "executable", "name")}
        for key in ("package", "executable"):
            if symbolic(found[key]):
                reason = f"the {key} of a node is known on the robot only: {found[key]}"
                self._problem(context, line, reason)
        arguments = _command(values, context)
        given = ros_arguments.ros2(arguments)
        stated = (*({name: Quoted(value)} for name, value in _private(given)), *given.files)
        settings = (*context.settings, *self._settings(stated, context, line),
                    *self._settings(values.get("parameters"), context, line))  # fmt: skip
        name = found["name"] or given.name
        namespace = joined(context.namespace, performed(values.get("namespace"), context) or given.namespace)
        own = name or found["executable"].rpartition("::")[2]
        inherited = first_of_each(context.remaps, namespace, own)
        remaps = (*context.remaps, *given.remaps, *_pairs(values.get("remappings"), context))
        self.nodes.append(
            LaunchedNode(
                found["package"],
                found["executable"],
                name,
                namespace,
                context.file,
                line,
                first_of_each(remaps, namespace, own),
                settings,
                arguments,
                kind,
                condition,
                len(inherited),
                "anon" if _anonymous(values.get("name")) else "",
                self.events > 0,
            )
        )

    def _settings(self, parameters: Any, context: Context, line: int) -> Iterator[Setting]:
        for one in parameters if isinstance(parameters, list | tuple) else ():
            if isinstance(one, dict):
                yield from self._stated(one, context, line, "")
                continue
            source = one.values if isinstance(one, Action) else {"param_file": one}
            name = performed(source.get("param_file"), context)
            if symbolic(name):
                self._problem(context, line, f"the parameter file {name} is not known here")
                continue
            try:
                content = read_text(Path(name), LARGEST)
            except UnreadableError as reason:
                self._problem(context, line, f"the parameter file {Path(name).name}: {reason}")
                continue
            yield Setting("~", Path(name), yaml=content)

    def _stated(
        self, values: Mapping[Any, Any], context: Context, line: int, above: str
    ) -> Iterator[Setting]:
        for key, value in values.items():
            context.spend()
            name = f"{above}{performed(key, context)}"
            if isinstance(value, dict):
                yield from self._stated(value, context, line, f"{name}.")
                continue
            setting = _setting(f"~{name}", value, context)
            if setting is None:
                self._problem(context, line, f"the parameter {name} is not constant")
                setting = Setting(f"~{name}", context.file, unknown=True)
            yield setting

    def _problem(self, context: Context, line: int, reason: str) -> None:
        problem = Problem(context.file, line, reason)
        if problem not in self.problems:
            self.problems.append(problem)


def _setting(name: str, value: Any, context: Context) -> Setting | None:
    """Return a parameter with a constant value; None if it is not constant."""
    if isinstance(value, Quoted):
        inner, kind = value.value, value.kind
        if kind not in ("", "str") or not isinstance(inner, Substitution | list | tuple | str):
            return _setting(name, inner, context)
        text = performed(inner, context)
        if symbolic(text):
            return None
        return Setting(name, context.file, text) if kind == "str" else _parsed(name, context, text)
    if isinstance(value, bool | int | float | str):
        return Setting(name, context.file, value)
    if isinstance(value, FilePath):
        return Setting(name, context.file, str(value))
    if isinstance(value, list | tuple):
        plain = all(isinstance(one, bool | int | float) for one in value)
        words = len(value) > 1 and all(isinstance(one, str) for one in value)
        if plain or words:
            return Setting(name, context.file, yaml=repr(list(value)))
    if isinstance(value, Unknown | Library):
        return None
    text = performed(value, context)  # ROS 2 parses the text of substitutions as YAML
    return None if symbolic(text) else _parsed(name, context, text)


def _parsed(name: str, context: Context, text: str) -> Setting:
    """Return a parameter whose text is YAML; an empty text stays a text."""
    return Setting(name, context.file, yaml=text) if text else Setting(name, context.file, "")


def _command(values: Mapping[str, Any], context: Context) -> str:
    """Return the arguments of a node; those of a list are quoted."""
    texts = []
    listed = isinstance(values.get("arguments"), list | tuple)
    for one in _listed(values.get("arguments")):
        text = performed(one, context)
        texts.append(shlex.quote(text) if listed and " " in text else text)
    more = [performed(one, context) for one in _listed(values.get("ros_arguments"))]
    return " ".join([*texts, *(["--ros-args", *more] if more else [])])


def _anonymous(name: Any) -> bool:
    """Return whether a name has a part that is made unique on the robot."""
    parts = name.parts if isinstance(name, Joined) else name if isinstance(name, list | tuple) else (name,)
    return any(isinstance(one, Anonymous) for one in parts)


def _private(given: ros_arguments.Given) -> Iterator[tuple[str, str]]:
    return ((name.removeprefix("~"), value) for name, value in given.parameters)


def _pairs(remaps: Any, context: Context) -> Iterator[tuple[str, str]]:
    for one in remaps if isinstance(remaps, list | tuple) else ():
        if isinstance(one, tuple | list) and len(one) == 2:
            yield performed(one[0], context), performed(one[1], context)


def _items(pairs: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the pairs of a dict, or of a list of pairs."""
    whole = pairs.items() if isinstance(pairs, dict) else pairs
    for one in whole if isinstance(whole, list | tuple | ItemsView) else ():
        if isinstance(one, tuple | list) and len(one) == 2:
            yield one[0], one[1]


def _listed(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, list | tuple) else () if value is None else (value,)
