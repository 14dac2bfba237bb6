"""ROS 2 message classes: generated from definitions, behaving as rosidl's do.

Fields are properties whose setters assert the type, so that `twist.linear.x = 1` fails here as on the robot.
Sequences of numbers are `array.array`, arrays of numbers are numpy arrays, as in rosidl.
"""

# ruff: noqa: S101 (rosidl's setters assert, and `python -O` switches them off there as well)

from __future__ import annotations

import operator
from array import array
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, ClassVar

from pytest_tarl.ros.messages import values
from pytest_tarl.ros.messages.definitions import Definition, Field, find_message, find_service
from pytest_tarl.ros.messages.values import CODES, INTEGERS, FieldError

_FLOAT32_LIMIT = (
    3.402823466e38  # as rosidl rounds it, so that the largest float32 of all is refused there too
)


class Message:
    """Base of all ROS 2 messages built here: keyword arguments only."""

    __slots__ = ()
    _tarl_fields: ClassVar[tuple[Field, ...]] = ()
    _fields_and_field_types: ClassVar[dict[str, str]] = {}
    _tarl_kind: ClassVar[str] = "ros2"
    _tarl_copy: ClassVar[Callable[[Any], Any]]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return field names and types as the message file gives them."""
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
        from pytest_tarl.ros.messages import message_type

        name = f"{type(self).__module__.replace('.', '/')}/{type(self).__name__}"
        return _rebuild, (
            message_type,
            name,
            {field.name: getattr(self, field.name) for field in self._tarl_fields},
        )


def _rebuild(find: Callable[[str], type], name: str, fields: dict[str, Any]) -> Any:
    return find(name)(**fields)


def _shown(value: Any) -> str:
    return repr(value.tolist()) if isinstance(value, array) else repr(value)


def _equal(one: Any, other: Any) -> bool:
    same = one == other
    return bool(same.all()) if hasattr(same, "all") else bool(same)


@cache
def message_class(package: str, name: str) -> type[Message] | None:
    """Return the class of a message type, built at first use; None if nobody knows the type."""
    definition = find_message("ros2", package, name)
    return build(definition, f"{package}.msg") if definition is not None else None


@cache
def service_class(package: str, name: str) -> type | None:
    """Return the class that stands for a service type, with `Request` and `Response`."""
    halves = find_service("ros2", package, name)
    if halves is None:
        return None
    request, response = (build(half, f"{package}.srv") for half in halves)
    return type(name, (), {"__module__": f"{package}.srv", "Request": request, "Response": response})


def build(definition: Definition, module: str) -> type[Message]:
    """Build the class of a definition."""
    fields = [field for field in definition.fields if field.name != "structure_needs_at_least_one_member"]
    scope: dict[str, Any] = {"new": object.__new__}
    for position, field in enumerate(fields):
        scope[f"default{position}"] = _default(field)
        scope[f"copy{position}"] = _copier(field)
    inits = [f"    self._{field.name} = default{position}()" for position, field in enumerate(fields)]
    copies = [_copy_line(field, position) for position, field in enumerate(fields)]
    source = [
        "def __init__(self, **kwargs):",
        *(inits or ["    pass"]),
        "    if kwargs: fill(self, kwargs)",
        "def copy(m):",
        "    n = new(cls)",
        *copies,
        "    return n",
    ]
    scope["fill"] = _fill
    exec(compile("\n".join(source), f"<message {definition.package}/{definition.name}>", "exec"), scope)  # noqa: S102
    namespace: dict[str, Any] = {
        "__slots__": ["_" + field.name for field in fields],
        "__module__": module,
        "__doc__": f"ROS 2 type {definition.package}/{definition.name}.",
        "__init__": scope["__init__"],
        "_tarl_fields": tuple(fields),
        "_fields_and_field_types": {field.name: _idl_text(field) for field in fields},
        "_tarl_copy": staticmethod(scope["copy"]),
        **{constant.name: constant.value for constant in definition.constants},
        **{field.name: property(operator.attrgetter("_" + field.name), _setter(field)) for field in fields},
    }
    scope["cls"] = built = type(definition.name, (Message,), namespace)
    return built


def _fill(message: Message, given: dict[str, Any]) -> None:
    names = [field.name for field in message._tarl_fields]
    assert all(key in names for key in given), "Invalid arguments passed to constructor: " + ", ".join(
        sorted(key for key in given if key not in names)
    )
    for key, value in given.items():
        setattr(message, key, value)


def _idl_text(field: Field) -> str:
    base = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet"}.get(
        field.base, field.base
    )
    return {"one": base, "array": f"{base}[{field.size}]", "sequence": f"sequence<{base}>"}[field.shape]


def _nested(base: str) -> type[Message]:
    built = message_class(*base.split("/"))
    if built is None:
        raise FieldError(f"message type {base} is not known")
    return built


# --- what a new message holds


def _default(field: Field) -> Callable[[], Any]:
    if field.default is not None:
        return lambda: field.default
    element = _element_default(field)
    if field.shape == "one":
        return element
    if field.base in CODES and field.base != "byte":
        if field.shape == "sequence":
            return lambda: array(CODES[field.base])
        return lambda: _numpy_array([0] * field.size, field.base)
    return (lambda: [element() for _ in range(field.size)]) if field.shape == "array" else list


def _element_default(field: Field) -> Callable[[], Any]:
    if not field.primitive:
        return _nested(field.base)
    if field.base == "byte":
        return lambda: bytes([0])
    zeros: dict[str, Callable[[], Any]] = {
        "bool": bool,
        "string": str,
        "wstring": str,
        "float32": float,
        "float64": float,
    }
    return zeros.get(field.base, int)


def _numpy_array(numbers: Any, base: str) -> Any:
    import numpy as np  # only messages with fixed arrays of numbers need it

    return np.array(numbers, dtype=base)


# --- what assignment accepts


def _setter(field: Field) -> Callable[[Any, Any], None]:
    slot, check = "_" + field.name, _check(field)
    if field.shape == "one":

        def set_one(message: Any, value: Any) -> None:
            check(value)
            object.__setattr__(message, slot, value)

        return set_one

    def set_many(message: Any, value: Any) -> None:
        object.__setattr__(message, slot, _accepted(field, check, value))

    return set_many


def _accepted(field: Field, check: Callable[[Any], None], value: Any) -> Any:
    """Check an assigned sequence and bring it into the form in which rosidl stores it."""
    packed = field.base in CODES and field.base != "byte"
    if packed and field.shape == "array" and hasattr(value, "dtype"):
        assert value.dtype.name == field.base, (
            f"The '{field.name}' numpy.ndarray() must have the dtype of '{field.base}'"
        )
        assert value.size == field.size, (
            f"The '{field.name}' numpy.ndarray() must have a size of {field.size}"
        )
        return value
    if packed and isinstance(value, array):
        assert value.typecode == CODES[field.base], (
            f"The '{field.name}' array.array() must have the type code of '{CODES[field.base]}'"
        )
        return value if field.shape == "sequence" else _numpy_array(_sized(field, value), field.base)
    assert isinstance(value, Sequence | set) and not isinstance(value, str), (  # noqa: PT018
        f"The '{field.name}' field must be a sequence of {field.base}, not {type(value).__name__}"
    )
    for element in value:
        check(element)
    _sized(field, value)
    if not packed:
        return value
    return (
        array(CODES[field.base], value)
        if field.shape == "sequence"
        else _numpy_array(list(value), field.base)
    )


def _sized(field: Field, value: Any) -> Any:
    assert field.shape == "sequence" or len(value) == field.size, (
        f"The '{field.name}' field must have {field.size} elements"
    )
    return value


def _check(field: Field) -> Callable[[Any], None]:
    """Return the assertion for one element."""
    if not field.primitive:
        wanted: type = _nested(field.base)
        said = f"a sub message of type '{field.base.rpartition('/')[2]}'"
    else:
        wanted = {
            "bool": bool,
            "string": str,
            "wstring": str,
            "float32": float,
            "float64": float,
            "byte": bytes,
        }.get(field.base, int)
        said = f"of type '{wanted.__name__}'"
    message = f"The '{field.name}' field must be {said}"
    low, high = INTEGERS.get(field.base, (0, 0))

    def check(value: Any) -> None:
        assert isinstance(value, wanted), message

    def check_integer(value: Any) -> None:
        assert isinstance(value, int), message
        assert low <= value <= high, f"The '{field.name}' field must be an integer in [{low}, {high}]"

    def check_float32(value: Any) -> None:
        assert isinstance(value, float), message
        assert not _FLOAT32_LIMIT < abs(value) < float("inf"), f"The '{field.name}' field must be a float32"

    return check_float32 if field.base == "float32" else check_integer if wanted is int else check


# --- what arrives


def _copy_line(field: Field, position: int) -> str:
    slot = f"_{field.name}"
    if field.shape == "one" and field.primitive and field.base != "float32":
        return f"    n.{slot} = m.{slot}"
    return f"    n.{slot} = copy{position}(m.{slot})"


def _copier(field: Field) -> Callable[[Any], Any]:
    if not field.primitive:
        element = _nested(field.base)._tarl_copy
        return element if field.shape == "one" else lambda value: [element(item) for item in value]
    if field.shape == "one":  # only float32 changes on the wire
        return lambda value: values.as_float32(value, field.name)
    if field.base in CODES and field.base != "byte":
        return (
            operator.itemgetter(slice(None)) if field.shape == "sequence" else operator.methodcaller("copy")
        )
    return list
