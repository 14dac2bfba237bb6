"""ROS 1 message classes that are generated from definitions and behave like genpy's.

Each class gets a function `_tarl_copy(message)` with the effect of sending and receiving: it checks types, rounds
float32, turns arrays of numbers into tuples (bytes for uint8), and shares nothing with the original.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from struct import Struct
from struct import error as StructError  # noqa: N812 (a class)
from typing import Any, ClassVar

from pytest_tarl.ros.messages import field_values, ros1_wire
from pytest_tarl.ros.messages.field_values import INTEGERS, FieldError
from pytest_tarl.ros.messages.node_workspaces import by_order
from pytest_tarl.ros.messages.times import Duration, Time, TVal
from pytest_tarl.ros.messages.type_definitions import Definition, Field, find_message, find_service, identity

# types without an installed class, built from a definition in a bag or a topic header
CARRIED: dict[str, type[Message]] = {}


class Message:
    """Base of all ROS 1 messages; takes all fields by position, or any fields by keyword."""

    __slots__ = ["_connection_header"]
    _type: ClassVar[str] = ""
    _md5sum: ClassVar[str] = ""
    _slot_types: ClassVar[list[str]] = []
    _has_header: ClassVar[bool] = False
    _tarl_kind: ClassVar[str] = "ros1"
    _tarl_copy: ClassVar[Callable[[Any], Any]]
    _tarl_defaults: ClassVar[dict[str, Callable[[], Any]]] = {}

    def __init__(self, *args: Any, **kwds: Any) -> None:
        slots, defaults = self.__slots__, self._tarl_defaults
        if args and kwds:
            raise TypeError("Message constructor may only use args OR keywords, not both")
        if args and len(args) != len(slots):
            raise TypeError(f"Invalid number of arguments, args should be {slots} args are{args}")
        for name in kwds:
            if name not in slots:
                raise AttributeError(f"{name} is not an attribute of {type(self).__name__}")
        given = dict(zip(slots, args, strict=True)) if args else kwds
        for name in slots:
            value = given.get(name)
            setattr(self, name, defaults[name]() if value is None else value)

    def serialize(self, buff: Any) -> None:
        """Serialise the message into a file."""
        buff.write(ros1_wire.serialize(self))

    def deserialize(self, data: bytes) -> Message:
        """Set all fields from bytes; return the message."""
        self.__setstate__(ros1_wire.deserialize(type(self), data, field_class).__getstate__())
        return self

    @property
    def _buff(self) -> bytes:
        """Return the serialised message, which a subscriber to any type receives on a robot."""
        return ros1_wire.serialize(self)

    def __getstate__(self) -> list[Any]:
        return [getattr(self, name) for name in self.__slots__]

    def __setstate__(self, state: list[Any]) -> None:
        for name, value in zip(self.__slots__, state, strict=True):
            setattr(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self._type, self.__getstate__())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        return all(_equal(getattr(self, name), getattr(other, name)) for name in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return as_yaml(self)

    __repr__ = __str__


def _equal(one: Any, other: Any) -> bool:
    """Compare two fields; lists can equal tuples, because received messages have tuples."""
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return tuple(one) == tuple(other)
    return bool(one == other)


def _rebuild(name: str, state: list[Any]) -> Message:
    """Unpickle a message by type name, because its module exists only during an episode."""
    built = field_class(name) or _service_part(name)
    if built is None:
        raise FieldError(f"message type {name} is not known")
    message: Message = object.__new__(built)
    message.__setstate__(state)
    return message


def _service_part(name: str) -> type[Message] | None:
    """Return the class of a service's request or response by its type name, `package/NameRequest`."""
    for suffix, part in (("Request", "_request_class"), ("Response", "_response_class")):
        service = service_class(*name.removesuffix(suffix).split("/")) if name.endswith(suffix) else None
        if service is not None:
            built: type[Message] = getattr(service, part)
            return built
    return None


def as_yaml(value: Any, indent: str = "") -> str:
    """Format a message like `rostopic echo`."""
    if isinstance(value, Message):
        lines = (
            f"{indent}{name}: {as_yaml(getattr(value, name), indent + '  ')}" for name in value.__slots__
        )
        return ("\n" if indent else "") + "\n".join(lines)
    if isinstance(value, TVal):
        return f"\n{indent}secs: {value.secs}\n{indent}nsecs: {value.nsecs:9d}"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"' if value else "''"
    if isinstance(value, bytes):
        return str(list(value))
    if isinstance(value, list | tuple) and value and isinstance(value[0], Message | TVal):
        return "\n" + "\n".join(f"{indent}- {as_yaml(item, indent + '  ')}" for item in value)
    return str(list(value)) if isinstance(value, list | tuple) else str(value)


_BUILT: dict[
    tuple[str, str, str], type[Any]
] = {}  # module, name and identity → class of a message or service


@by_order
def message_class(package: str, name: str) -> type[Message] | None:
    """Return the class of a message type, built when first used, or None if it is unknown.

    Workspaces with the same definition share a class.
    """
    definition = find_message("ros1", package, name)
    if definition is None:
        return None
    key = (f"{package}.msg", name, identity([definition]))
    if key not in _BUILT:
        _BUILT[key] = build(definition, f"{package}.msg")
    return _BUILT[key]


def field_class(base: str) -> type[Message] | None:
    """Return the class of a message type by full name, including parts of services and actions."""
    return message_class(*base.split("/", 1)) or CARRIED.get(base)


@by_order
def service_class(package: str, name: str) -> type | None:
    """Return the class of a service type; its request and response classes are attributes."""
    halves = find_service("ros1", package, name)
    if halves is None:
        return None
    key = (f"{package}.srv", name, identity(halves))
    if key not in _BUILT:
        _BUILT[key] = _service(package, name, halves)
    return _BUILT[key]


def _service(package: str, name: str, halves: tuple[Definition, Definition]) -> type:
    request, response = (build(half, f"{package}.srv") for half in halves)
    namespace = {"_type": f"{package}/{name}", "_request_class": request, "_response_class": response}
    checksum = _md5sum("".join(md5_text(half) for half in halves))
    return type(name, (), {**namespace, "_md5sum": checksum, "__module__": f"{package}.srv"})


def build(definition: Definition, module: str) -> type[Message]:
    """Build the class of a definition."""
    scope: dict[str, Any] = {
        "FieldError": FieldError,
        "Time": Time,
        "Duration": Duration,
        "values": field_values,
    }
    defaults: dict[str, Callable[[], Any]] = {}
    lines = []
    for position, field in enumerate(definition.fields):
        defaults[field.name] = scope[f"default{position}"] = _default(field)
        scope[f"slow{position}"] = _converter(field)
        lines.append(_copy_lines(field, position, scope))
    inits = [f"    self.{f.name} = default{i}()" for i, f in enumerate(definition.fields)] or ["    pass"]
    alone = definition.fields[0].name if len(definition.fields) == 1 else ""
    source = [
        "def __init__(self, *args, **kwds):",
        *(
            [f"    if len(args) == 1 and not kwds and args[0] is not None: self.{alone}, = args; return"]
            if alone
            else []
        ),
        "    if args or kwds:",
        "        return base_init(self, *args, **kwds)",
        *inits,
        "def copy(m):",
        "    n = new(cls)",
        *(line for group in lines for line in group),
        "    return n",
    ]
    scope["base_init"], scope["new"] = Message.__init__, object.__new__
    exec(compile("\n".join(source), f"<message {definition.package}/{definition.name}>", "exec"), scope)  # noqa: S102
    namespace = {
        "__slots__": [f.name for f in definition.fields],
        "__module__": module,
        "__doc__": f"ROS 1 type {definition.package}/{definition.name}.",
        "__init__": scope["__init__"],
        "_type": f"{definition.package}/{definition.name}",
        "_slot_types": [field.text for field in definition.fields],
        "_md5sum": _md5sum(md5_text(definition)),
        "_has_header": bool(definition.fields) and definition.fields[0].base == "std_msgs/Header",
        "_tarl_copy": staticmethod(scope["copy"]),
        "_tarl_defaults": defaults,
        **{constant.name: constant.value for constant in definition.constants},
    }
    scope["cls"] = built = type(definition.name, (Message,), namespace)
    return built


def md5_text(definition: Definition) -> str:
    """Return the text that ROS 1 hashes: constants, then fields, with nested types as their checksums."""
    lines = [f"{constant.text}\n" for constant in definition.constants]
    for field in definition.fields:
        kind = field.text if field.primitive else _nested(field.base)._md5sum
        lines.append(f"{kind} {field.name}\n")
    return "".join(lines).strip()


def _md5sum(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()


def _default(field: Field) -> Callable[[], Any]:
    element = _element_default(field)
    if field.shape == "one":
        return element
    if field.base in ("uint8", "char"):
        return (lambda: bytes(field.size)) if field.shape == "array" else (lambda: b"")
    return (lambda: [element() for _ in range(field.size)]) if field.shape == "array" else list


def _element_default(field: Field) -> Callable[[], Any]:
    if field.base == "time":
        return Time
    if field.base == "duration":
        return Duration
    if not field.primitive:
        return _nested(field.base)
    zeros: dict[str, Callable[[], Any]] = {"bool": bool, "string": str, "float32": float, "float64": float}
    return zeros.get(field.base, int)


def _nested(base: str) -> type[Message]:
    built = message_class(*base.split("/")) or CARRIED.get(base)
    if built is None:
        raise FieldError(f"message type {base} is not known")
    return built


def _copy_lines(field: Field, position: int, scope: dict[str, Any]) -> list[str]:
    """Return source lines that copy a field: inline for a value of the exact type, otherwise by calling `slow`."""
    name, slow = field.name, f"slow{position}(v, {field.name!r})"
    exact = {"float64": "float", "string": "str", "bool": "bool"}.get(field.base)
    if field.shape == "one" and not field.primitive:
        scope[f"type{position}"] = nested = _nested(field.base)
        scope[f"copy{position}"] = nested._tarl_copy
        usual, copied = f"v.__class__ is type{position}", f"copy{position}(v)"
    elif field.shape == "one" and field.base in INTEGERS:
        low, high = INTEGERS[field.base]
        usual, copied = f"v.__class__ is int and {low} <= v <= {high}", "v"
    elif field.shape == "one" and exact is not None:
        usual, copied = f"v.__class__ is {exact}", "v"
    else:
        return [f"    v = m.{name}", f"    n.{name} = {slow}"]
    return [f"    v = m.{name}", f"    n.{name} = {copied} if {usual} else {slow}"]


def _converter(field: Field) -> Callable[[Any, str], Any]:
    size = field.size
    if field.shape == "one":
        return _element_converter(field)
    if field.base in ("uint8", "char"):
        return lambda value, name: (
            bytes(value)
            if not size and isinstance(value, bytes)
            else bytes(field_values.as_numbers(value, "uint8", size, name))
        )
    if field.base in field_values.CODES:
        packed = _packed_converter(field.base, size)
        return _same_doubles(size, packed) if field.base == "float64" and size else packed
    convert = _element_converter(field)
    return lambda value, name: field_values.as_list(value, size, name, convert)


def _packed_converter(base: str, size: int) -> Callable[[Any, str], Any]:
    last: Any = ()  # the last result, which can be reused because a tuple of numbers is immutable

    def convert(value: Any, name: str) -> Any:
        nonlocal last
        if value is not last or size:
            if value is last and len(value) == size:
                return value
            last = tuple(field_values.as_numbers(value, base, size, name))
        return last

    return convert


def _same_doubles(size: int, convert: Callable[[Any, str], Any]) -> Callable[[Any, str], Any]:
    """Return a conversion that reuses the last result for equal bytes, because covariances rarely change."""
    pack = Struct(f"{size}d").pack
    last: tuple[bytes, Any] = (b"", ())

    def convert_new(value: Any, name: str) -> Any:
        nonlocal last
        if value is last[1]:
            return value
        if value.__class__ is not list:
            return convert(value, name)
        try:
            content = pack(*value)
        except StructError:
            return convert(value, name)  # this raises the error with the reason
        if content != last[0]:
            last = (content, convert(value, name))
        return last[1]

    return convert_new


def _element_converter(field: Field) -> Callable[[Any, str], Any]:
    if field.base in ("time", "duration"):
        return lambda value, name: _as_time(value, Time if field.base == "time" else Duration, name)
    if field.primitive:
        return field_values.scalar_converter(field.base)
    nested = _nested(field.base)

    def convert(value: Any, name: str) -> Any:
        if not isinstance(value, nested):
            shown = getattr(type(value), "_type", type(value).__name__)
            raise FieldError(f"field {name!r} must be of type {field.base}, not {shown}")
        return nested._tarl_copy(value)

    return convert


def _as_time(value: Any, wanted: type[TVal], name: str) -> TVal:
    if not isinstance(value, TVal):
        raise FieldError(f"field {name!r} must be a {wanted.__name__}, not {value!r}")
    twin = object.__new__(wanted)
    twin.secs, twin.nsecs = value.secs, value.nsecs
    return twin
