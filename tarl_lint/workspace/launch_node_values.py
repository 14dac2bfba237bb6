"""Values of a node in a ROS 2 launch file: its parameters, arguments, remappings and name."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import ItemsView, Iterator, Mapping
from typing import Any, Final

from tarl_lint.workspace import ros_arguments
from tarl_lint.workspace.launch_actions import Quoted
from tarl_lint.workspace.launch_model import Setting
from tarl_lint.workspace.launch_values import Anonymous, Context, Joined, Substitution, performed, symbolic
from tarl_lint.workspace.python.evaluator import Library, Unknown
from tarl_lint.workspace.python.paths import FilePath

_SIMPLE: Final = re.compile(r"[\w./+-]+")  # matches a text that stays one value inside a list of YAML


def setting(name: str, value: Any, context: Context) -> Setting | None:
    """Return a parameter with a constant value; None if it is not constant."""
    if isinstance(value, Quoted):
        inner, kind = value.value, value.kind
        if kind not in ("", "str") or not isinstance(inner, Substitution | list | tuple | str):
            return setting(name, inner, context)
        text = performed(inner, context)
        if symbolic(text):
            return None
        return Setting(name, context.file, text) if kind == "str" else _parsed(name, context, text)
    if isinstance(value, bool | int | float | str):
        return Setting(name, context.file, value)
    if isinstance(value, FilePath):
        return Setting(name, context.file, str(value))
    if isinstance(value, list | tuple):
        listed = _listed_values(value, context)
        if listed:
            return None if symbolic(listed) else Setting(name, context.file, yaml=listed)
    if isinstance(value, Unknown | Library):
        return None
    text = performed(value, context)  # ROS 2 parses the text of substitutions as YAML
    return None if symbolic(text) else _parsed(name, context, text)


def _listed_values(value: list[Any] | tuple[Any, ...], context: Context) -> str:
    """Return a list as YAML with the types of launch_ros; "" for parts of one string."""
    if all(isinstance(one, bool | int | float) for one in value):
        real = any(isinstance(one, float) for one in value)
        return repr([float(one) if real and not isinstance(one, bool) else one for one in value])
    if all(isinstance(one, str) for one in value):
        return repr(list(value))
    if any(isinstance(one, list | tuple) for one in value):
        texts = [performed(one, context) for one in value]  # the text of each element is YAML
        return f"[{', '.join(one if _SIMPLE.fullmatch(one) else json.dumps(one) for one in texts)}]"
    return ""


def _parsed(name: str, context: Context, text: str) -> Setting:
    """Return a parameter whose text is YAML; an empty string stays a string."""
    return Setting(name, context.file, yaml=text) if text else Setting(name, context.file, "")


def command(values: Mapping[str, Any], context: Context) -> str:
    """Return the arguments of a node; if they are given as a list, each is quoted."""
    texts = []
    quoted = isinstance(values.get("arguments"), list | tuple)
    for one in _listed(values.get("arguments")):
        text = performed(one, context)
        texts.append(shlex.quote(text) if quoted and " " in text else text)
    more = [performed(one, context) for one in _listed(values.get("ros_arguments"))]
    return " ".join([*texts, *(["--ros-args", *more] if more else [])])


def anonymous(name: Any) -> bool:
    """Return whether a part of a name is made unique on the robot."""
    parts = name.parts if isinstance(name, Joined) else name if isinstance(name, list | tuple) else (name,)
    return any(isinstance(one, Anonymous) for one in parts)


def private(given: ros_arguments.Given) -> Iterator[tuple[str, str]]:
    """Yield the parameters in the arguments of a node, without `~`."""
    return ((name.removeprefix("~"), value) for name, value in given.parameters)


def pairs(remaps: Any, context: Context) -> Iterator[tuple[str, str]]:
    """Yield the remappings of a list of pairs."""
    for one in remaps if isinstance(remaps, list | tuple | ItemsView) else ():
        if isinstance(one, tuple | list) and len(one) == 2:
            yield performed(one[0], context), performed(one[1], context)


def items_of(values: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the pairs of a dict, or of a list of pairs."""
    whole = values.items() if isinstance(values, dict) else values
    for one in whole if isinstance(whole, list | tuple | ItemsView) else ():
        if isinstance(one, tuple | list) and len(one) == 2:
            yield one[0], one[1]


def _listed(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, list | tuple) else () if value is None else (value,)
