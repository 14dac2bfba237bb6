"""Read ROS 2 launch files in XML and YAML as the same actions that Python files give."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from tarl_lint.workspace.launch_actions import Action, Condition, Quoted, gz_bridge
from tarl_lint.workspace.launch_values import (
    Anonymous,
    Choice,
    Comparison,
    Configuration,
    Content,
    Expression,
    Here,
    Joined,
    Logic,
    OnRobot,
    Package,
)

_IGNORED: Final = frozenset(["executable", "append_env", "reset_env", "log", "log_info",
                             "shutdown", "set_ros_log_dir", "keep", "env", "param", "remap"])  # fmt: skip

_LOGIC: Final = {"not": "not", "and": "and", "or": "or", "all": "and", "any": "or"}
_QUOTED: Final = re.compile(r"""(["'])((?:\\.|(?!\1)[^\\])*)\1""", re.DOTALL)
_ESCAPED: Final = re.compile(r"""\\(["'])""")


@dataclass
class Entity:
    """An XML element, or a YAML mapping with its name. `-` in names is replaced by `_`."""

    tag: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Entity] = field(default_factory=list)

    def get(self, name: str) -> Any:
        """Return an attribute with its substitutions; None if it is absent."""
        text = self.attributes.get(name)
        return None if text is None else substitutions(text)

    def all(self, *tags: str) -> Iterator[Entity]:
        """Yield the children with one of the tags."""
        return (one for one in self.children if one.tag in tags)


def actions(entities: list[Entity]) -> list[Action]:
    """Return the actions of elements, in order."""
    return [made for entity in entities for made in _made(entity)]


def _made(entity: Entity) -> Iterator[Action]:
    tag = entity.tag
    if tag in _MAKERS:
        kind, values = _MAKERS[tag]
        yield Action(kind, entity.line, {**values(entity), **_condition(entity)})
    elif tag not in _IGNORED:
        yield Action("unread", entity.line, {"reason": f"<{tag}> is not followed"})


def _group(entity: Entity) -> dict[str, Any]:
    scoped = entity.tag == "group" and entity.attributes.get("scoped", "true").lower() != "false"
    return {
        "actions": actions(entity.children),
        "scoped": scoped,
        "forwarding": entity.get("forwarding") or "true",
        "launch_configurations": _kept(entity),
    }


def _kept(entity: Entity) -> list[tuple[Any, Any]]:
    return [(one.get("name"), one.get("value")) for one in entity.all("keep")]


def _include(entity: Entity) -> dict[str, Any]:
    pairs = [(one.get("name"), one.get("value")) for one in entity.all("arg", "let")]
    return {"source": entity.get("file"), "arguments": pairs}


def _node(entity: Entity) -> dict[str, Any]:
    get = entity.get
    return {
        "package": get("pkg"),
        "executable": get("exec"),
        "plugin": get("plugin"),
        "name": get("name"),
        "namespace": get("namespace"),
        "arguments": get("args"),
        "ros_arguments": get("ros_args"),
        "remappings": [(one.get("from"), one.get("to")) for one in entity.all("remap")],
        "parameters": [_parameter(one) for one in entity.all("param")],
        "components": [
            Action("component", one.line, {**_node(one), **_condition(one)})
            for one in entity.all("composable_node")
        ],
    }


_TRUTHS: Final[Mapping[str, bool]] = {"true": True, "True": True, "false": False, "False": False}
_NODE: Final = ("node", _node)
_NAMESPACE: Final = ("namespace", lambda e: {"namespace": e.get("namespace")})
_MAKERS: Final[Mapping[str, tuple[str, Callable[[Entity], dict[str, Any]]]]] = {
    "arg": ("argument", lambda e: {"name": e.get("name"), "default_value": e.get("default")}),
    "let": ("set", lambda e: {"name": e.get("name"), "value": e.get("value")}),
    "group": ("group", _group),
    "timer": ("group", _group),
    "ros_timer": ("group", _group),
    "set_env": ("environment", lambda e: {"name": e.get("name"), "value": e.get("value")}),
    "unset_env": ("unset environment", lambda e: {"name": e.get("name")}),
    "reset": ("reset", lambda e: {"launch_configurations": _kept(e)}),
    "include": ("include", _include),
    "push_ros_namespace": _NAMESPACE,
    "push_namespace": _NAMESPACE,
    "set_remap": ("remap", lambda e: {"src": e.get("from"), "dst": e.get("to")}),
    "set_parameter": ("parameter", lambda e: {"name": e.get("name"), "value": _value(e)}),
    "set_parameters_from_file": ("parameter file", lambda e: {"filename": e.get("filename")}),
    "set_use_sim_time": ("parameter", lambda e: {"name": "use_sim_time", "value": _value(e)}),
    "node": _NODE,
    "lifecycle_node": _NODE,
    "node_container": ("container", _node),
    "load_composable_node": ("load", _node),
    "ros_gz_bridge": (
        "node",
        lambda e: gz_bridge(e.line, {name: e.get(name) for name in e.attributes}).values,
    ),
}


def _parameter(entity: Entity) -> Any:
    if "from" in entity.attributes:
        values = {"param_file": entity.get("from"), "allow_substs": entity.get("allow_substs")}
        return Action("parameters of a file", entity.line, values)
    return {entity.get("name"): _stated(entity)}


def _stated(entity: Entity) -> Any:
    inner = list(entity.all("param"))
    return {one.get("name"): _stated(one) for one in inner} if inner else _value(entity)


def _value(entity: Entity) -> Any:
    kind, separator = entity.attributes.get("type"), entity.attributes.get("value-sep")
    if separator:
        return _separated(entity.attributes.get("value", "").split(separator), kind == "list_of_str")
    return Quoted(entity.get("value"), "str" if kind == "str" else "")


def _separated(parts: list[str], texts: bool) -> list[Any]:
    """Return a separated attribute as a list of numbers, truth values or strings."""
    if any("$(" in one for one in parts):
        return [[substitutions(one)] for one in parts]
    for kind in () if texts else (int, float, _TRUTHS.__getitem__):
        with contextlib.suppress(ValueError, KeyError):
            return [kind(one) for one in parts]
    return parts


def _condition(entity: Entity) -> dict[str, Condition]:
    for name, wanted in (("if", True), ("unless", False)):
        if name in entity.attributes:
            return {"condition": Condition(entity.get(name), wanted=wanted)}
    return {}


def substitutions(text: str) -> Any:
    """Parse the substitutions `$(…)` in a string."""
    parts: list[Any] = []
    place = 0
    while (start := text.find("$(", place)) >= 0:
        end = _end(text, start)
        if end < 0:
            break
        parts += [text[place:start]] if start > place else []
        parts.append(_substitution(text[start + 2 : end]))
        place = end + 1
    parts += [text[place:]] if place < len(text) or not parts else []
    return parts[0] if len(parts) == 1 else Joined(tuple(parts))


def _end(text: str, start: int) -> int:
    """Return the index of the matching closing parenthesis, or -1."""
    depth = 0
    for index in range(start + 1, len(text)):
        depth += {"(": 1, ")": -1}.get(text[index], 0)
        if not depth:
            return index
    return -1


def _substitution(inside: str) -> Any:
    name, _, rest = inside.strip().partition(" ")
    rest = rest.strip()
    if name == "eval":
        plain = next(_words(rest), "") if rest[:1] in ("'", '"') else rest
        return Expression((substitutions(plain),))
    words = [substitutions(word) for word in _words(rest)]
    first = words[0] if words else ""
    if name == "var":
        return Configuration(first, words[1] if len(words) > 1 else None)
    if name == "find-pkg-share":
        return Package(first)
    if name in ("dirname", "filename"):
        return Here(whole=name == "filename")
    if name == "anon":
        return Anonymous(first)
    if name in ("env", "optenv"):
        default = words[1] if len(words) > 1 else "" if name == "optenv" else None
        return OnRobot(inside, default)
    if name in ("equals", "not-equals") and len(words) == 2:
        return Comparison(first, words[1], equal=name == "equals")
    if name in _LOGIC:
        return Logic(_LOGIC[name], tuple(words))
    if name == "file-content":
        return Content(first)
    if name == "if" and len(words) > 1:
        return Choice(first, words[1], words[2] if len(words) > 2 else "")
    return OnRobot(inside)


def _words(text: str) -> Iterator[str]:
    """Split at spaces, except within quotes and parentheses."""
    place = 0
    while place < len(text):
        if text[place].isspace():
            place += 1
            continue
        start = place
        quoted = _QUOTED.match(text, place)
        if quoted is not None:
            yield _ESCAPED.sub(r"\1", quoted[2])
            place = quoted.end()
            continue
        while place < len(text) and not text[place].isspace():
            end = _end(text, place) if text.startswith("$(", place) else place
            place = max(end, place) + 1
        yield text[start:place]
