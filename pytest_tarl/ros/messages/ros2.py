"""ROS 2 message classes that are generated from definitions and behave like rosidl's.

Fields are properties whose setters assert the type, so `twist.linear.x = 1` fails here as on a robot. As in rosidl,
sequences of numbers are `array.array`, and fixed arrays of numbers are numpy arrays.
"""

# ruff: noqa: S101 (rosidl's setters assert, and `python -O` switches them off there as well)

from __future__ import annotations

import keyword
import operator
from array import array
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from pytest_tarl.ros.messages.field_values import CODES, FieldError
from pytest_tarl.ros.messages.node_workspaces import by_order
from pytest_tarl.ros.messages.ros2_copy import copy_function
from pytest_tarl.ros.messages.ros2_fields import LITERALS, default, setter
from pytest_tarl.ros.messages.type_definitions import (
    Constant,
    Definition,
    Field,
    find_action,
    find_message,
    find_service,
    identity,
    parse,
)


class Message:
    """Base of all ROS 2 messages built here; takes keyword arguments only."""

    __slots__: ClassVar[Sequence[str]] = ()
    _check_fields: ClassVar[bool] = True
    _tarl_fields: ClassVar[tuple[Field, ...]] = ()
    _fields_and_field_types: ClassVar[dict[str, str]] = {}
    _tarl_kind: ClassVar[str] = "ros2"
    _tarl_copy: ClassVar[Callable[[Any], Any]]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return field names and types, as in the message file."""
        return dict(cls._fields_and_field_types)

    def __repr__(self) -> str:
        shown = ", ".join(f"{field.name}={_shown(getattr(self, field.name))}" for field in self._tarl_fields)
        return f"{type(self).__module__}.{type(self).__qualname__}({shown})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        return all(
            _equal(getattr(self, field.name), getattr(other, field.name)) for field in self._tarl_fields
        )

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Any:
        twin = object.__new__(type(self))
        for field in self._tarl_fields:
            slot = "_" + field.name
            object.__setattr__(twin, slot, getattr(self, slot))
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        return type(self)._tarl_copy(self)

    def __reduce__(self) -> tuple[Any, ...]:
        fields = {field.name: getattr(self, field.name) for field in self._tarl_fields}
        return _rebuild, (type(self).__module__, type(self).__name__, fields)


def _rebuild(module: str, name: str, fields: dict[str, Any]) -> Message:
    """Unpickle a message; in another process, its class may not have been built yet."""
    package, _, part = module.partition(".")
    built = _nested(f"{package}/{name}") if part == "msg" else _part(package, name, part)
    return built(**fields)


def _part(package: str, name: str, part: str) -> type[Message]:
    """Return the class of a part of a service or action, such as `SetBool_Request`, by name."""
    whole = (
        service_class(package, name.rpartition("_")[0])
        if part == "srv"
        else action_class(package, name.partition("_")[0])
    )
    pending = [] if whole is None else [whole]
    while pending:
        one = pending.pop()
        if issubclass(one, Message):
            if one.__name__ == name:
                return one
        else:
            pending += [inner for inner in vars(one).values() if isinstance(inner, type)]
    raise FieldError(f"{part} type {package}/{name} is not known")


def _shown(value: Any) -> str:
    return repr(value.tolist()) if isinstance(value, array) else repr(value)


def _equal(one: Any, other: Any) -> bool:
    same = one == other
    return bool(same.all()) if hasattr(same, "all") else bool(same)


# module, name and identity → class of a message, service or action
_BUILT: dict[tuple[str, str, str], type[Any]] = {}


@by_order
def message_class(package: str, name: str) -> type[Message] | None:
    """Return the class of a message type, built when first used, or None if it is unknown.

    Workspaces with the same definition share a class.
    """
    definition = find_message("ros2", package, name)
    if definition is None:
        return None
    key = (f"{package}.msg", name, identity([definition]))
    if key not in _BUILT:
        _BUILT[key] = build(definition, f"{package}.msg")
    return _BUILT[key]


@by_order
def service_class(package: str, name: str) -> type | None:
    """Return the class of a service type, with `Request` and `Response`."""
    halves = find_service("ros2", package, name)
    if halves is None:
        return None
    key = (f"{package}.srv", name, identity(halves))
    if key not in _BUILT:
        _BUILT[key] = _service(package, name, halves)
    return _BUILT[key]


def _service(package: str, name: str, halves: tuple[Definition, Definition]) -> type:
    request, response = (build(half, f"{package}.srv") for half in halves)
    return type(name, (), {"__module__": f"{package}.srv", "Request": request, "Response": response})


@by_order
def action_class(package: str, name: str) -> type | None:
    """Return the class of an action type, with `Goal`, `Result`, `Feedback` and their transport messages."""
    parts = find_action("ros2", package, name)
    if parts is None:
        return None
    key = (f"{package}.action", name, identity(parts))
    if key not in _BUILT:
        _BUILT[key] = _action(package, name, parts)
    return _BUILT[key]


def _action(package: str, name: str, parts: tuple[Definition, Definition, Definition]) -> type:
    goal, result, feedback = (build(part, f"{package}.action") for part in parts)
    action = type(
        name, (), {"__module__": f"{package}.action", "Goal": goal, "Result": result, "Feedback": feedback}
    )
    action.Impl = type("Impl", (), _carriers(package, name, parts))  # type: ignore[attr-defined]
    return action


def _carriers(package: str, name: str, parts: tuple[Definition, ...]) -> dict[str, Any]:
    """Build the services and messages that transport the parts of an action, as rosidl does."""
    goal, result, feedback = (f"{package}/{part.name}" for part in parts)
    uuid = "unique_identifier_msgs/UUID goal_id"
    texts = {
        "SendGoal_Request": f"{uuid}\n{goal} goal",
        "SendGoal_Response": "bool accepted\nbuiltin_interfaces/Time stamp",
        "GetResult_Request": uuid,
        "GetResult_Response": f"int8 status\n{result} result",
        "FeedbackMessage": f"{uuid}\n{feedback} feedback",
    }
    made = {
        key: build(parse("ros2", package, f"{name}_{key}", text), f"{package}.action")
        for key, text in texts.items()
    }
    services = {
        f"{service}Service": type(
            f"{name}_{service}",
            (),
            {"Request": made[f"{service}_Request"], "Response": made[f"{service}_Response"]},
        )
        for service in ("SendGoal", "GetResult")
    }
    return {**services, "FeedbackMessage": made["FeedbackMessage"]}


def build(definition: Definition, module: str) -> type[Message]:
    """Build the class of a definition."""
    fields = list(definition.fields)
    scope: dict[str, Any] = {"new": object.__new__, "fill": _fill, "UNSET": _UNSET, "array": array}
    for position, field in enumerate(fields):
        scope[f"default{position}"] = default(field, _nested)
    source = [*_init_lines(fields), *copy_function(fields, _nested, scope)]
    setters = {f.name: setter(f, position, _nested, scope, source) for position, f in enumerate(fields)}
    exec(compile("\n".join(source), f"<message {definition.package}/{definition.name}>", "exec"), scope)  # noqa: S102
    namespace: dict[str, Any] = {
        "__slots__": ["_" + field.name for field in fields],
        "__module__": module,
        "__doc__": f"ROS 2 type {definition.package}/{definition.name}.",
        "__init__": scope["__init__"],
        "SLOT_TYPES": tuple(_idl_text(field) for field in fields),
        "_tarl_fields": tuple(fields),
        "_fields_and_field_types": {field.name: _idl_text(field) for field in fields},
        "_tarl_copy": staticmethod(scope["copy"]),
        **{constant.name: _constant(constant) for constant in definition.constants},
        **{
            name: property(operator.attrgetter("_" + name), scope[function])
            for name, function in setters.items()
        },
    }
    scope["cls"] = built = type(definition.name, (Message,), namespace)
    built.__slots__ = [*namespace["__slots__"], "_check_fields"]  # type: ignore[attr-defined]  # as rosidl lists them; ours always checks
    if not module.endswith(".msg"):
        _parts[f"{definition.package}/{definition.name}"] = built
    return built


def _constant(constant: Constant) -> Any:
    """Return a constant's value; rosidl makes a `byte` a `bytes` object of length 1."""
    return bytes([constant.value]) if constant.text.split()[0] in ("byte", "octet") else constant.value


PACKED = frozenset(CODES) - {"byte"}  # types that rosidl stores in an `array.array`
_UNSET = object()
_parts: dict[str, type[Message]] = {}  # parts of services and actions, which transport messages need


def _init_lines(fields: list[Field]) -> list[str]:
    """Return the source lines of the constructor: a keyword with a default for each field."""
    if any(keyword.iskeyword(field.name) or field.name in ("self", "unknown") for field in fields):
        defaults = [f"    self._{field.name} = default{position}()" for position, field in enumerate(fields)]
        return ["def __init__(self, **unknown):", *defaults, "    fill(self, unknown)"]
    given = "".join(f"{field.name}=UNSET, " for field in fields)
    lines = [
        f"def __init__(self, {'*, ' if fields else ''}{given}**unknown):",
        "    if unknown: fill(self, unknown)",
    ]
    for position, field in enumerate(fields):
        plain = LITERALS.get(field.base) if field.shape == "one" and field.default is None else None
        lines.append(f"    if {field.name} is UNSET: self._{field.name} = {plain or f'default{position}()'}")
        code = _packed_code(field)  # rosidl's constructors, unlike its setters, convert the value to an array
        given = f"array({code!r}, {field.name})" if code else field.name
        lines.append(f"    else: self.{field.name} = {given}")
    return lines


def _packed_code(field: Field) -> str:
    """Return the type code of a sequence of numbers; empty for other fields."""
    return CODES[field.base] if field.shape == "sequence" and field.base in PACKED else ""


def _fill(message: Message, given: dict[str, Any]) -> None:
    names = {field.name: _packed_code(field) for field in message._tarl_fields}
    given.pop("check_fields", None)  # an option of newer rosidl; TARL always checks the fields
    assert all(key in names for key in given), "Invalid arguments passed to constructor: " + ", ".join(
        sorted(key for key in given if key not in names)
    )
    for key, value in given.items():
        setattr(message, key, array(names[key], value) if names[key] else value)


def _idl_text(field: Field) -> str:
    base = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet"}.get(
        field.base, field.base
    )
    return {"one": base, "array": f"{base}[{field.size}]", "sequence": f"sequence<{base}>"}[field.shape]


def _nested(base: str) -> type[Message]:
    built = _parts.get(base) or message_class(*base.split("/"))
    if built is None:
        raise FieldError(f"message type {base} is not known")
    return built
