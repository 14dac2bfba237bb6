"""What a message type consists of: from the definitions that `rosbags` ships and a few that it lacks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from pytest_tarl.errors import UnsupportedApiError
from pytest_tarl.ros.messages.extras import MESSAGES, SERVICES

Kind = Literal["ros1", "ros2"]
Shape = Literal["one", "array", "sequence"]

DEFAULTS: Mapping[
    str, Mapping[str, Any]
] = {  # rosbags drops default values; these are all in common packages
    "ros2:geometry_msgs/Quaternion": {"w": 1.0},
}
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
    """One field. `base` is a primitive or `package/Name`; `size` is the length of an array."""

    name: str
    base: str
    shape: Shape = "one"
    size: int = 0
    default: Any = None

    @property
    def primitive(self) -> bool:
        """Tell whether the elements are numbers, texts or (ROS 1) times."""
        return self.base in _PRIMITIVES

    @property
    def text(self) -> str:
        """Write the type as a message file does: `float64[36]`."""
        return self.base + {"one": "", "array": f"[{self.size}]", "sequence": "[]"}[self.shape]


@dataclass(frozen=True, slots=True)
class Constant:
    """A named constant of a message type."""

    name: str
    value: Any


@dataclass(frozen=True, slots=True)
class Definition:
    """A message type, or one half of a service type."""

    kind: Kind
    package: str
    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()


def find_message(kind: Kind, package: str, name: str) -> Definition | None:
    """Return the definition of a message type, None if nobody knows it."""
    own = MESSAGES.get(kind, {}).get(f"{package}/{name}")
    if own is not None:
        return parse(kind, package, name, own)
    shipped = _store(kind).get(f"{package}/msg/{name}")
    return _from_store(kind, package, name, shipped) if shipped is not None else None


def find_service(kind: Kind, package: str, name: str) -> tuple[Definition, Definition] | None:
    """Return request and response of a service type, None if nobody knows it."""
    own = SERVICES.get(kind, {}).get(f"{package}/{name}")
    if own is None:
        return None
    request, _, response = own.partition("---")
    suffixes = ("Request", "Response") if kind == "ros1" else ("_Request", "_Response")
    return parse(kind, package, name + suffixes[0], request), parse(
        kind, package, name + suffixes[1], response
    )


@cache
def message_names(kind: Kind, package: str) -> tuple[str, ...]:
    """List the message types of a package."""
    shipped = [name.rpartition("/")[2] for name in _store(kind) if name.startswith(f"{package}/")]
    own = [name.partition("/")[2] for name in MESSAGES.get(kind, {}) if name.startswith(f"{package}/")]
    return tuple(sorted({*shipped, *own}))


@cache
def service_names(kind: Kind, package: str) -> tuple[str, ...]:
    """List the service types of a package."""
    return tuple(sorted(n.partition("/")[2] for n in SERVICES.get(kind, {}) if n.startswith(f"{package}/")))


def parse(kind: Kind, package: str, name: str, text: str) -> Definition:
    """Read a message definition as it stands in a `.msg` file (one half of a `.srv` file)."""
    fields, constants = [], []
    for line in text.splitlines():
        line = line.split("#")[0].strip()
        if not line:
            continue
        kind_of_value, rest = line.split(None, 1)
        left, assigned, value = rest.partition("=")
        if assigned:
            constants.append(Constant(left.strip(), _constant(kind_of_value, value.strip())))
        else:
            fields.append(_field(kind_of_value, left.split(), package))
    return Definition(kind, package, name, tuple(fields), tuple(constants))


def _field(type_text: str, words: list[str], package: str) -> Field:
    base, bracket, size = type_text.partition("[")
    base = base.split("<=")[0]
    if base == "Header":
        base = "std_msgs/Header"
    if base not in _PRIMITIVES and "/" not in base:
        base = f"{package}/{base}"
    default = _constant(base, words[1]) if len(words) > 1 else None
    size = size.rstrip("]")
    shape: Shape = "one" if not bracket else "array" if size.isdigit() else "sequence"
    return Field(words[0], base, shape, int(size) if size.isdigit() else 0, default)


def _constant(type_text: str, value: str) -> Any:
    if type_text.startswith("float"):
        return float(value)
    if type_text.startswith(("string", "wstring")):
        return value.strip("'\"")
    return value.lower() in ("true", "1") if type_text == "bool" else int(value, 0)


@cache
def _store(kind: Kind) -> Mapping[str, Any]:
    try:
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise UnsupportedApiError(
            "ROS message types were asked for, but neither ROS nor `rosbags`, which ships their definitions, is "
            'installed in this environment: run `pip install "tarl[ros]"`.'
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
        tuple(_store_field(kind, field_name, node, defaults.get(field_name)) for field_name, node in fields),
        tuple(Constant(constant_name, value) for constant_name, _, value in constants),
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
