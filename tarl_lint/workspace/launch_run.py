"""Interpret the actions of a ROS 2 launch file: nodes with names, remappings and parameters.

The actions come from Python, XML or YAML. None of them is executed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from tarl_lint.workspace import ros_arguments
from tarl_lint.workspace.bounded_files import UnreadableError, read_text
from tarl_lint.workspace.conditions import combined
from tarl_lint.workspace.launch_actions import Action, Condition, Quoted, gz_bridge
from tarl_lint.workspace.launch_entities import substitutions
from tarl_lint.workspace.launch_model import Kind, LaunchedNode, Setting
from tarl_lint.workspace.launch_node_values import anonymous, command, items_of, pairs, private, setting
from tarl_lint.workspace.launch_values import Context, performed, symbolic, truth
from tarl_lint.workspace.model import Problem
from tarl_lint.workspace.name_resolution import joined, package_in
from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.ros_arguments import first_of_each

LARGEST: Final = 1_000_000  # maximum size of a YAML file (bytes)
DEEPEST: Final = 20  # maximum nesting of includes
_GZ_BRIDGE: Final = "$(find-pkg-share ros_gz_bridge)/launch/ros_gz_bridge.launch"
MOST: Final = 5_000  # maximum number of actions of a launch file with its includes
SUBSTITUTION: Final = re.compile(r"\$\([^()]*\)")


Opener = Callable[[Path, Context, list[Problem]], Any]  # function that returns the actions of a launch file


@dataclass
class Runner:
    """Interprets actions and collects nodes. `opened` reads an included launch file."""

    opened: Opener
    nodes: list[LaunchedNode] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    arguments: set[str] = field(default_factory=set)  # names of the declared arguments
    required: set[str] = field(default_factory=set)  # names of the declared arguments without a value
    # the files through which the current action is included, with their arguments
    including: list[object] = field(default_factory=list)
    seen: int = 0
    # conditionally declared arguments without a value
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
                self._problem(context, action.line, f"`{action.text}` is not followed", hides=True)

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
            kept = _performed(values.get("launch_configurations"), context)
            if performed(values.get("forwarding", True), context).lower() == "false":
                inner.reset()
            inner.configurations.update(kept)
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
            self._problem(context, action.line, str(values.get("reason")), hides=True)
        elif action.kind in ("unset", "unset environment", "push", "pop", "reset"):
            _forget(action, context)
        else:
            self._set(action, context, condition)

    def _set(self, action: Action, context: Context, condition: str) -> None:
        """Apply an action that changes the context of later actions. Under a condition, it sets symbolic values."""
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
        elif kind == "namespace":
            pushed = performed(values.get("namespace"), context)
            self._unknown(context, action.line, "the namespace of a group", pushed)
            context.namespace = joined(context.namespace, text("namespace"))
        elif kind == "environment":
            context.environment[name] = text("value")
        elif kind == "remap":
            pair = performed(values.get("src"), context), performed(values.get("dst"), context)
            self._unknown(context, action.line, "a remapping", *pair)
            context.remaps.append((pair[0], text("dst")))
        elif kind == "parameter":
            stated = {values.get("name"): values.get("value")}
            given = self._stated(stated, context, action.line, "")
            if condition:
                given = (Setting(one.name, one.file, unknown=True) for one in given)
            context.settings.extend(given)
        elif kind == "parameter file":
            context.settings.extend(self._settings([values.get("filename")], context, action.line))

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
        # the bridge is usually installed without its source
        if name.startswith(_GZ_BRIDGE):
            bridged = {
                key: value for key, value in items_of(action.values.get("arguments")) if isinstance(key, str)
            }
            self._node(gz_bridge(action.line, bridged), context, condition)
            return
        if symbolic(name) or not name:
            reason = f"the included file {name or '?'} is not in the workspace"
            given = tuple(performed(one, context) for _, one in items_of(action.values.get("arguments")))
            self._problem(context, action.line, reason, hides=True, package=package_in(name), given=given)
            return
        self._opaque(
            context, action.line, f"the arguments of {Path(name).name}", action.values.get("arguments")
        )
        for key, value in items_of(action.values.get("arguments")):
            context.configurations[performed(key, context)] = performed(value, context)
        here = (Path(name), frozenset(context.configurations.items()))
        if here in self.including or len(self.including) >= DEEPEST:
            said = "it includes itself" if here in self.including else "files include each other"
            self._problem(context, action.line, f"{Path(name).name}: {said}", hides=True)
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
            self._problem(context, action.line, "a node has neither package nor executable", hides=True)
            return
        self._started(values, context, action.line, kind, condition)
        self._components(values.get("components"), context, condition)

    def _components(self, components: Any, context: Context, condition: str) -> None:
        """Add the composable nodes of a container."""
        if isinstance(components, Unknown):
            self._problem(context, components.line, f"`{components.text}` is not followed", hides=True)
        for one in components if isinstance(components, list | tuple) else ():
            if isinstance(one, Action) and one.kind == "component":
                holds, unsure = self._holds(one, context)
                if holds:
                    values = {**one.values, "executable": one.values.get("plugin")}
                    own = combined(one.values.get("assumed", ""), unsure)
                    self._started(values, context, one.line, "component", combined(condition, own))
            elif isinstance(one, Unknown):
                self._problem(context, one.line, f"`{one.text}` is not followed", hides=True)

    def _started(
        self, values: Mapping[str, Any], context: Context, line: int, kind: Kind, condition: str
    ) -> None:
        found = {key: performed(values.get(key), context) for key in ("package", "executable", "name")}
        stated_namespace = performed(values.get("namespace"), context)
        arguments = command(values, context)
        own_remaps = tuple(pairs(values.get("remappings"), context))
        for key in ("package", "executable", "name"):
            self._unknown(context, line, f"the {key} of a node", found[key])
        called = found["name"] or found["executable"]
        of_node = "of a node" if symbolic(called) or not called else f"of {called}"
        self._unknown(context, line, f"the namespace {of_node}", stated_namespace)
        self._unknown(context, line, f"the command line {of_node}", arguments)
        for pair in own_remaps:
            self._unknown(context, line, f"a remapping {of_node}", *pair)
        remappings = values.get("remappings")
        each = remappings if isinstance(remappings, list | tuple) else (remappings,)
        self._opaque(context, line, f"the remappings {of_node}", *each)
        self._opaque(context, line, f"the parameters {of_node}", values.get("parameters"))
        given = ros_arguments.ros2(arguments)
        stated = (*({name: Quoted(value)} for name, value in private(given)), *given.files)
        settings = (*context.settings, *self._settings(stated, context, line),
                    *self._settings(values.get("parameters"), context, line))  # fmt: skip
        name = found["name"] or given.name
        namespace = joined(context.namespace, stated_namespace or given.namespace)
        own = name or found["executable"].rpartition("::")[2]
        inherited = first_of_each(context.remaps, namespace, own)
        remaps = (*context.remaps, *given.remaps, *own_remaps)
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
                "anon" if anonymous(values.get("name")) else "",
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
            if truth(performed(source.get("allow_substs"), context)):
                content = performed(substitutions(content), context)
                for text in dict.fromkeys(SUBSTITUTION.findall(content)):
                    self._unknown(context, line, f"a value in the parameter file {Path(name).name}", text)
            yield Setting("~", Path(name), yaml=content)

    def _stated(
        self, values: Mapping[Any, Any], context: Context, line: int, above: str
    ) -> Iterator[Setting]:
        for key, value in values.items():
            context.spend()
            name = f"{above}{performed(key, context)}"
            self._unknown(context, line, "the name of a parameter", name)
            if isinstance(value, dict):
                yield from self._stated(value, context, line, f"{name}.")
                continue
            stated = setting(f"~{name}", value, context)
            if stated is None:
                self._problem(context, line, f"the parameter {name} is not constant")
                stated = Setting(f"~{name}", context.file, unknown=True)
            yield stated

    def _unknown(self, context: Context, line: int, what: str, *texts: str) -> None:
        """Record a problem if one of the texts depends on values known only on the robot."""
        if any(map(symbolic, texts)):
            self._problem(context, line, f"{what} is known on the robot only: {' -> '.join(texts)}")

    def _opaque(self, context: Context, line: int, what: str, *values: Any) -> None:
        """Record a problem for each value that the launch file computes in a way that is not followed."""
        for one in values:
            if isinstance(one, Unknown | Library):
                text = one.text if isinstance(one, Unknown) else one.name
                self._problem(context, line, f"{what}: `{text}` is not constant")

    def _problem(
        self,
        context: Context,
        line: int,
        reason: str,
        *,
        hides: bool = False,
        package: str = "",
        given: tuple[str, ...] = (),
    ) -> None:
        problem = Problem(context.file, line, reason, hides, package, given)
        if problem not in self.problems:
            self.problems.append(problem)


def _forget(action: Action, context: Context) -> None:
    """Remove launch configurations, or save and restore them."""
    values, kind = action.values, action.kind
    if kind == "unset":
        context.configurations.pop(performed(values.get("name"), context), None)
    elif kind == "unset environment":
        context.environment.pop(performed(values.get("name"), context), None)
    elif kind == "push":
        context.saved.append(context.inside())
    elif kind == "pop" and context.saved:
        context.restore(context.saved.pop())
    elif kind == "reset":
        kept = _performed(values.get("launch_configurations"), context)
        context.reset()
        context.configurations.update(kept)


def _performed(values: Any, context: Context) -> dict[str, str]:
    """Return launch configurations with their substitutions replaced."""
    return {performed(key, context): performed(value, context) for key, value in items_of(values)}
