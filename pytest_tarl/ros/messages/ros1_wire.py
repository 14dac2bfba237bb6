"""Serialise ROS 1 messages: little-endian fields in order, with lengths as uint32.

Format: https://wiki.ros.org/msg, "Array handling" and "Primitive types".
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from pytest_tarl.ros.messages.times import Duration, Time
from pytest_tarl.ros.messages.type_definitions import Definition, find_message

_CODES = {
    "bool": "?", "byte": "b", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
_TIMES = {"time": (Time, "<II"), "duration": (Duration, "<ii")}
_LENGTH = struct.Struct("<I")
Find = Callable[[str], Any]


class WireError(ValueError):
    """The bytes are not a message of this type."""


def serialize(message: Any) -> bytes:
    """Serialise a message. Raise FieldError for a value that does not fit its field."""
    parts: list[bytes] = []
    # classes of an installed ROS have no `_tarl_copy`, because they check values when they serialise
    copied = getattr(type(message), "_tarl_copy", None)
    _write_message(message if copied is None else copied(message), parts)
    return b"".join(parts)


def deserialize(kind: Any, data: bytes, find: Find) -> Any:
    """Deserialise a message of a class; `find` returns a nested class by type name.

    Raise WireError if there are too few or too many bytes.
    """
    try:
        message, end = _read_message(kind, data, 0, find)
    except (struct.error, UnicodeDecodeError) as problem:
        raise WireError(f"the bytes are not a valid {kind._type}: {problem}") from problem
    if end != len(data):
        raise WireError(f"{len(data) - end} bytes are left after a {kind._type}")
    return message


def full_text(kind: Any) -> str:
    """Return the definition of a message type and of all nested types, as stored in bags."""
    texts: dict[str, str] = {}
    pending = [kind._type]
    while pending:
        name = pending.pop(0)
        definition = find_message("ros1", *name.split("/"))
        if name not in texts and definition is not None:
            texts[name] = _text(definition)
            pending += [field.base for field in definition.fields if not field.primitive]
    first, *others = texts.items()
    return first[1] + "".join(f"{'=' * 80}\nMSG: {name}\n{text}" for name, text in others)


def _text(definition: Definition) -> str:
    lines = [constant.text for constant in definition.constants]
    lines += [f"{field.text} {field.name}" for field in definition.fields]
    return "".join(f"{line}\n" for line in lines)


def _write_message(message: Any, parts: list[bytes]) -> None:
    for name, kind in zip(message.__slots__, message._slot_types, strict=True):
        _write(getattr(message, name), kind, parts)


def _write(value: Any, kind: str, parts: list[bytes]) -> None:
    base, bracket, size = kind.partition("[")
    if not bracket:
        _write_one(value, base, parts)
        return
    if size == "]":
        parts.append(_LENGTH.pack(len(value)))
    if base in _CODES:
        parts.append(
            bytes(value) if isinstance(value, bytes) else struct.pack(f"<{len(value)}{_CODES[base]}", *value)
        )
        return
    for one in value:
        _write_one(one, base, parts)


def _write_one(value: Any, base: str, parts: list[bytes]) -> None:
    if base in _CODES:
        parts.append(struct.pack(f"<{_CODES[base]}", value))
    elif base == "string":
        data = value.encode()
        parts += [_LENGTH.pack(len(data)), data]
    elif base in _TIMES:
        parts.append(struct.pack(_TIMES[base][1], value.secs, value.nsecs))
    else:
        _write_message(value, parts)


def _read_message(kind: Any, data: bytes, at: int, find: Find) -> tuple[Any, int]:
    message = kind()
    for name, slot in zip(kind.__slots__, kind._slot_types, strict=True):
        value, at = _read(slot, data, at, find)
        setattr(message, name, value)
    return message, at


def _read(kind: str, data: bytes, at: int, find: Find) -> tuple[Any, int]:
    base, bracket, size = kind.partition("[")
    if not bracket:
        return _read_one(base, data, at, find)
    count = int(size.rstrip("]") or 0)
    if size == "]":
        (count,), at = _LENGTH.unpack_from(data, at), at + _LENGTH.size
    # each element takes at least one byte, unless its type is empty
    if count > len(data):
        raise WireError(f"an array of {count} elements does not fit {len(data)} bytes")
    if base in ("uint8", "char"):
        if at + count > len(data):
            raise WireError("an array is longer than the remaining bytes")
        return data[at : at + count], at + count
    if base in _CODES:
        numbers = struct.Struct(f"<{count}{_CODES[base]}")
        return numbers.unpack_from(data, at), at + numbers.size
    found = []
    for _ in range(count):
        one, at = _read_one(base, data, at, find)
        found.append(one)
    return found, at


def _read_one(base: str, data: bytes, at: int, find: Find) -> tuple[Any, int]:
    if base in _CODES:
        (value,) = struct.unpack_from(f"<{_CODES[base]}", data, at)
        return value, at + struct.calcsize(_CODES[base])
    if base == "string":
        (count,), at = _LENGTH.unpack_from(data, at), at + _LENGTH.size
        if at + count > len(data):
            raise WireError("a string is longer than the remaining bytes")
        return data[at : at + count].decode(errors="replace"), at + count
    if base in _TIMES:
        made, form = _TIMES[base]
        return made(*struct.unpack_from(form, data, at)), at + 8
    kind = find(base)
    if kind is None:
        raise WireError(f"message type {base} is not known")
    return _read_message(kind, data, at, find)
