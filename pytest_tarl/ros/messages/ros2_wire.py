"""Serialise ROS 2 messages as DDS does: CDR, little-endian, each number aligned to its size."""

from __future__ import annotations

import re
import struct
import sys
from array import array
from typing import Any, NamedTuple

_HEADER = b"\x00\x01\x00\x00"  # CDR, little-endian, no options
_CODES = {"boolean": "?", "octet": "B", "char": "B", "float": "f", "double": "d", "int8": "b", "uint8": "B",
          "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q"}  # fmt: skip
_FORM = re.compile(
    r"(?:sequence<(?P<inner>[^,]+?)(?:, *\d+)?>|(?P<array>[^\[]+)\[(?P<size>\d+)\]|(?P<one>.+))$"
)


class _Field(NamedTuple):
    """A field: its element type, and the number of elements (1, an array's length, or None for a sequence)."""

    name: str
    base: str
    length: int | None
    single: bool


_KNOWN: dict[type[Any], tuple[_Field, ...]] = {}


def _fields(kind: type[Any]) -> tuple[_Field, ...]:
    known = _KNOWN.get(kind)
    if known is None:
        known = _KNOWN[kind] = tuple(_read_fields(kind))
    return known


def _read_fields(kind: type[Any]) -> list[_Field]:
    found = []
    for name, form in kind.get_fields_and_field_types().items():
        match = _FORM.fullmatch(form)
        if match is None:
            raise TypeError(f"the type of field {name} is not understood: {form}")
        base = match["inner"] or match["array"] or match["one"]
        base = re.sub(r"<.*>$", "", base)  # bounded strings
        length = None if match["inner"] else int(match["size"] or 1)
        found.append(_Field(name, base, length, match["one"] is not None))
    return found


def serialize(message: Any) -> bytes:
    """Return a message as bytes, with the encapsulation header."""
    out = bytearray()
    _write_message(out, message)
    return _HEADER + bytes(out)


def deserialize(data: bytes, kind: type[Any]) -> Any:
    """Return the message of class `kind` in these bytes. Raise ValueError if they are not little-endian CDR."""
    if bytes(data[:2]) != _HEADER[:2]:
        raise ValueError("the bytes are not a message in little-endian CDR")
    try:
        return _Reader(memoryview(data)[4:]).message(kind)
    except (struct.error, IndexError, UnicodeDecodeError) as error:
        raise ValueError(f"the bytes are not a valid {kind.__name__}: {error}") from None


def _write_message(out: bytearray, message: Any) -> None:
    fields = _fields(type(message))
    if not fields:
        out.append(0)  # an empty structure has one byte
    for field in fields:
        value = getattr(message, field.name)
        elements = [value] if field.single else value
        if field.length is None:
            _write(out, "I", len(elements))
        _write_elements(out, field.base, elements)


def _write_elements(out: bytearray, base: str, elements: Any) -> None:
    code = _CODES.get(base)
    if code is None:
        for element in elements:
            _write_one(out, base, element)
    elif len(elements):
        out.extend(bytes(-len(out) % struct.calcsize(code)))
        if base == "octet":
            elements = [element[0] for element in elements]
        if isinstance(elements, array) and elements.typecode == code and sys.byteorder == "little":
            out.extend(elements.tobytes())
        else:
            out.extend(struct.pack(f"<{len(elements)}{code}", *elements))


def _write(out: bytearray, code: str, number: int) -> None:
    out.extend(bytes(-len(out) % struct.calcsize(code)))
    out.extend(struct.pack(f"<{code}", number))


def _write_one(out: bytearray, base: str, element: Any) -> None:
    if base == "string":
        text = element.encode() + b"\0"
        _write(out, "I", len(text))
        out.extend(text)
    elif base == "wstring":
        units = element.encode("utf-16-le")
        _write(out, "I", len(units) // 2)
        out.extend(units)
    else:
        _write_message(out, element)


class _Reader:
    """Read values one after another."""

    def __init__(self, data: memoryview) -> None:
        self._data = data
        self._at = 0

    def message(self, kind: type[Any]) -> Any:
        made = kind()
        fields = _fields(kind)
        if not fields:
            self._at += 1
        for field in fields:
            count = self._numbers("I", 1)[0] if field.length is None else field.length
            elements = self._elements(field.base, count)
            setattr(made, field.name, elements[0] if field.single else elements)
        return made

    def _elements(self, base: str, count: int) -> list[Any]:
        code = _CODES.get(base)
        if code is not None:
            numbers = self._numbers(code, count)
            return [bytes([one]) for one in numbers] if base == "octet" else numbers
        if count > len(self._data):
            raise IndexError(f"{count} elements do not fit {len(self._data)} bytes")
        return [self._one(base) for _ in range(count)]

    def _one(self, base: str) -> Any:
        if base == "string":
            return bytes(self._numbers("B", self._numbers("I", 1)[0])[:-1]).decode()
        if base == "wstring":
            return self._take(2 * self._numbers("I", 1)[0]).decode("utf-16-le")
        from pytest_tarl.ros.messages import message_type

        package, _, name = base.partition("/")
        return self.message(message_type(f"{package}/msg/{name.rpartition('/')[2]}"))

    def _numbers(self, code: str, count: int) -> list[Any]:
        if not count:
            return []
        size = struct.calcsize(code)
        self._at += -self._at % size
        return list(struct.unpack(f"<{count}{code}", self._take(count * size)))

    def _take(self, size: int) -> bytes:
        if self._at + size > len(self._data):
            raise IndexError(f"expected {self._at + size} bytes, got {len(self._data)}")
        self._at += size
        return bytes(self._data[self._at - size : self._at])
