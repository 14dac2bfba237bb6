"""Definitions of message types: from `rosbags`, from the workspace, and built in."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.extras import install_command
from pytest_tarl.ros.messages.known import Part, known_types
from pytest_tarl.ros.messages.node_workspaces import by_order, workspace_types
from tarl_lint.workspace.interface_syntax import constant

Kind = Literal["ros1", "ros2"]
Shape = Literal["one", "array", "sequence"]

DEFAULTS: Mapping[str, Mapping[str, Any]] = {  # default values in common packages, which rosbags drops
    "ros2:geometry_msgs/Quaternion": {"w": 1.0},
}
# dummy member of ROS 2 types without fields, which programs do not see
_FILLER = "structure_needs_at_least_one_member"
_PRIMITIVES = frozenset(
    [
        "bool",
        "byte",
        "char",
        "int8",
        "uint8",
        "int16",
        "uint16",
        "int32",
        "uint32",
        "int64",
        "uint64",
        "float32",
        "float64",
        "string",
        "wstring",
        "time",
        "duration",
    ]
)


@dataclass(frozen=True, slots=True)
class Field:
    """A field; `base` is a primitive type or `package/Name`, and `size` is the length of an array."""

    name: str
    base: str
    shape: Shape = "one"
    size: int = 0
    default: Any = None

    @property
    def primitive(self) -> bool:
        """Return whether the elements are numbers, strings or (in ROS 1) times."""
        return self.base in _PRIMITIVES

    @property
    def text(self) -> str:
        """Return the type as in a message file, such as `float64[36]`."""
        return self.base + {"one": "", "array": f"[{self.size}]", "sequence": "[]"}[self.shape]


@dataclass(frozen=True, slots=True)
class Constant:
    """A named constant of a message type; `text` is its line in the text of the ROS 1 checksum."""

    name: str
    value: Any
    text: str = ""


@dataclass(frozen=True, slots=True)
class Definition:
    """A message type, or one half of a service type."""

    kind: Kind
    package: str
    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()


@by_order
def find_message(kind: Kind, package: str, name: str) -> Definition | None:
    """Return the definition of a message type, or None if it is unknown."""
    own = _text(kind, "msg", f"{package}/{name}")
    if own is not None:
        return parse(kind, package, name, own)
    shipped = _store(kind).get(f"{package}/msg/{name}")
    if shipped is not None:
        return _from_store(kind, package, name, shipped)
    return _part_of_action(package, name) if kind == "ros1" else None


def find_service(kind: Kind, package: str, name: str) -> tuple[Definition, Definition] | None:
    """Return request and response of a service type, or None if it is unknown."""
    own = _text(kind, "srv", f"{package}/{name}")
    if own is None:
        return None
    suffixes = ("Request", "Response") if kind == "ros1" else ("_Request", "_Response")
    request, response = _sections(own, 2)
    return parse(kind, package, name + suffixes[0], request), parse(
        kind, package, name + suffixes[1], response
    )


def find_action(kind: Kind, package: str, name: str) -> tuple[Definition, Definition, Definition] | None:
    """Return goal, result and feedback of an action type, or None if it is unknown."""
    own = _text(kind, "action", f"{package}/{name}")
    if own is None:
        return None
    joint = "" if kind == "ros1" else "_"
    goal, result, feedback = (
        parse(kind, package, f"{name}{joint}{half}", text)
        for half, text in zip(("Goal", "Result", "Feedback"), _sections(own, 3), strict=True)
    )
    return goal, result, feedback


def identity(definitions: Iterable[Definition]) -> str:
    """Return a text that identifies the class of a message, or the classes of a service or action.

    It consists of the definitions and of those of all messages in their fields, because two workspaces may define the
    same name differently.
    """
    own = [*definitions]
    inside: dict[str, Definition | None] = {}
    pending = [*own]
    while pending:
        definition = pending.pop()
        for base in {field.base for field in definition.fields if not field.primitive} - inside.keys():
            found = inside[base] = find_message(definition.kind, *base.split("/", 1))
            pending += [] if found is None else [found]
    return repr((own, sorted(inside.items())))


_ACTION_MESSAGES = {  # messages that genaction generates for an action, outermost last
    "Goal": None,
    "Result": None,
    "Feedback": None,
    "ActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n{0}Goal goal",
    "ActionResult": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{0}Result result",
    "ActionFeedback": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{0}Feedback feedback",
    "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback",
}


def _part_of_action(package: str, name: str) -> Definition | None:
    """Return one of the seven messages that ROS 1 generates for an action."""
    for ending, template in reversed(_ACTION_MESSAGES.items()):
        halves = find_action("ros1", package, name.removesuffix(ending)) if name.endswith(ending) else None
        if halves is not None:
            if template is None:
                return halves[("Goal", "Result", "Feedback").index(ending)]
            return parse("ros1", package, name, template.format(name.removesuffix(ending)))
    return None


def _text(kind: Kind, part: Part, name: str) -> str | None:
    """Return a definition: from the user's workspace or, if it has none, from the known types."""
    return workspace_types(part).get(name) or known_types(kind, part).get(name)


def _sections(text: str, count: int) -> list[str]:
    """Split a definition at lines of dashes."""
    found = [""]
    for line in text.splitlines():
        if line.strip() == "---":
            found.append("")
        else:
            found[-1] += line + "\n"
    return (found + [""] * count)[:count]


def type_names(kind: Kind, package: str, part: Part) -> tuple[str, ...]:
    """Return the names of a package's messages, services or actions."""
    own = [name.partition("/")[2] for name in workspace_types(part) if name.startswith(f"{package}/")]
    names = {*own, *_fixed_names(kind, package, part)}
    if kind == "ros1" and part == "msg":
        names |= {n + ending for n in type_names(kind, package, "action") for ending in _ACTION_MESSAGES}
    return tuple(sorted(names))


@by_order
def contained_packages(package: str, part: Part) -> frozenset[str]:
    """Return the packages of all message types that a ROS 1 package's types contain, at any depth."""
    pending = [one for name in type_names("ros1", package, part) for one in _halves(package, name, part)]
    seen: set[str] = set()
    while pending:
        inner = {field.base for field in pending.pop().fields if not field.primitive} - seen
        seen |= inner
        found = (find_message("ros1", *base.split("/")) for base in sorted(inner))
        pending += [one for one in found if one is not None]
    return frozenset(base.partition("/")[0] for base in seen)


def _halves(package: str, name: str, part: Part) -> tuple[Definition, ...]:
    """Return the definition of a ROS 1 message, or those of a service's request and response."""
    if part == "srv":
        return find_service("ros1", package, name) or ()
    message = find_message("ros1", package, name)
    return (message,) if message is not None else ()


@cache
def has_known_types(package: str) -> bool:
    """Return whether `rosbags` or TARL itself has definitions of the package."""
    kinds: tuple[Kind, ...] = ("ros1", "ros2")
    parts: tuple[Part, ...] = ("msg", "srv", "action")
    return any(_fixed_names(kind, package, part) for kind in kinds for part in parts)


@cache
def _fixed_names(kind: Kind, package: str, part: Part) -> frozenset[str]:
    """Return the names of the types that do not come from the user's workspace."""
    shipped = _store(kind) if part == "msg" else {}
    names = (name for table in (shipped, known_types(kind, part)) for name in table)
    return frozenset(name.rpartition("/")[2] for name in names if name.startswith(f"{package}/"))


def parse(kind: Kind, package: str, name: str, text: str) -> Definition:
    """Parse a message definition: a `.msg` file, or one section of a `.srv` or `.action` file.

    Raises:
        UnsupportedApiError: A line has no name, or a constant or a default has no value of its type.
    """
    fields, constants = [], []
    for line in text.splitlines():
        line = _without_comment(kind, line)
        if not line:
            continue
        kind_of_value, *more = line.split(None, 1)
        if not more:
            raise UnsupportedApiError(
                f"{package}/{name}: `{line}` is neither a field nor a constant: correct the definition."
            )
        rest = more[0]
        left, assigned, value = rest.partition("=")
        if assigned:
            text = f"{kind_of_value} {left.strip()}={value.strip()}"
            try:
                constants.append(Constant(left.strip(), constant(kind_of_value, value.strip()), text))
            except ValueError:
                raise UnsupportedApiError(
                    f"{package}/{name}: the constant `{text}` has no value of its type: correct the definition."
                ) from None
        elif rest.strip() != _FILLER:
            try:
                fields.append(_field(kind, kind_of_value, rest, package))
            except ValueError:
                raise UnsupportedApiError(
                    f"{package}/{name}: the default in `{line}` is no value of its type: correct the definition."
                ) from None
    return Definition(kind, package, name, tuple(fields), tuple(constants))


def _without_comment(kind: Kind, line: str) -> str:
    """Remove the comment; in a ROS 1 string constant, `#` belongs to the value."""
    head = line.split("#")[0]
    return (line if kind == "ros1" and head.lstrip().startswith("string ") and "=" in head else head).strip()


_TIMES = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}


def _field(kind: Kind, type_text: str, rest: str, package: str) -> Field:
    name, _, default_text = rest.strip().partition(" ")
    base, bracket, size = type_text.partition("[")
    base = base.split("<=")[0]
    if base == "Header":
        base = "std_msgs/Header"
    if kind == "ros2":
        base = _TIMES.get(base, base)
    if base not in _PRIMITIVES and "/" not in base:
        base = f"{package}/{base}"
    size = size.rstrip("]")
    shape: Shape = "one" if not bracket else "array" if size.isdigit() else "sequence"
    default = (
        _default_value(base, default_text.strip(), many=shape != "one") if default_text.strip() else None
    )
    return Field(name, base, shape, int(size) if size.isdigit() else 0, default)


def _default_value(base: str, text: str, *, many: bool) -> Any:
    if many:
        return [constant(base, item.strip()) for item in text.strip("[]").split(",") if item.strip()]
    return constant(base, text)


@cache
def _store(kind: Kind) -> Mapping[str, Any]:
    try:
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise UnsupportedApiError(
            "The definitions of ROS message types are missing: neither ROS nor `rosbags`, which contains them, is "
            f"installed in this environment: run {install_command('ros')}."
        ) from error
    store = get_typestore(Stores.ROS1_NOETIC if kind == "ros1" else Stores.LATEST)
    return {name: definition for name, definition in store.fielddefs.items() if "/msg/" in name}


def _from_store(kind: Kind, package: str, name: str, shipped: Any) -> Definition:
    constants, fields = shipped
    defaults = DEFAULTS.get(f"{kind}:{package}/{name}", {})
    return Definition(
        kind,
        package,
        name,
        tuple(
            _store_field(kind, field_name, node, defaults.get(field_name))
            for field_name, node in fields
            if field_name != _FILLER
        ),
        tuple(Constant(named, value, f"{base} {named}={value}") for named, base, value in constants),
    )


def _store_field(kind: Kind, name: str, node: Any, default: Any) -> Field:
    node_type, detail = node
    shape: Shape = "one"
    size = 0
    if node_type.name in ("ARRAY", "SEQUENCE"):
        shape = "array" if node_type.name == "ARRAY" else "sequence"
        (node_type, detail), size = detail
    base = detail[0] if node_type.name == "BASE" else detail.replace("/msg/", "/")
    if kind == "ros1":
        base = {"builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration"}.get(base, base)
    return Field(name, base, shape, size if shape == "array" else 0, default)
