"""Convert field values to what a receiver gets. Every function raises FieldError for unsuitable values."""

from __future__ import annotations

import operator
from array import array
from collections.abc import Callable, Iterable
from struct import Struct
from typing import Any

_FLOAT32 = Struct("<f")
INTEGERS = {
    "byte": (-128, 127), "int8": (-128, 127), "int16": (-(2**15), 2**15 - 1), "int32": (-(2**31), 2**31 - 1),
    "int64": (-(2**63), 2**63 - 1), "char": (0, 255), "uint8": (0, 255), "uint16": (0, 2**16 - 1),
    "uint32": (0, 2**32 - 1), "uint64": (0, 2**64 - 1),
}  # fmt: skip
CODES = {
    "float32": "f", "float64": "d", "byte": "b", "int8": "b", "int16": "h", "int32": "i", "int64": "q",
    "char": "B", "uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q",
}  # fmt: skip


class FieldError(Exception):
    """A field's value does not fit its type; the message is the end of a sentence."""


def as_float(value: Any, field: str) -> float:
    """Convert a number to float64. Raise FieldError for other values."""
    if isinstance(value, str | bytes) or not hasattr(value, "__float__"):
        raise FieldError(f"field {field!r} must be a number, not {value!r}")
    return float(value)


def as_float32(value: Any, field: str) -> float:
    """Round a number to float32. Raise FieldError for other values and for numbers that are too large."""
    try:
        rounded: float = _FLOAT32.unpack(_FLOAT32.pack(as_float(value, field)))[0]
    except OverflowError as error:
        raise FieldError(f"field {field!r} is too large for float32: {value!r}") from error
    return rounded


def as_integer(value: Any, base: str, field: str) -> int:
    """Return an integer that fits `base`. Raise FieldError for other values, including floats, as ROS does."""
    low, high = INTEGERS[base]
    try:
        number = operator.index(value)
    except TypeError as error:
        raise FieldError(f"field {field!r} must be an integer, not {value!r}") from error
    if not low <= number <= high:
        raise FieldError(f"field {field!r} must lie within {base}, from {low} to {high}, not {number}")
    return number


def as_bool(value: Any, field: str) -> bool:
    """Return a boolean. Raise FieldError for other values."""
    if isinstance(value, bool):
        return value
    try:
        return bool(operator.index(value))
    except TypeError as error:
        if type(value).__module__ == "numpy" and type(value).__name__ in ("bool", "bool_"):
            return bool(value)  # numpy 2's bool has no __index__
        raise FieldError(f"field {field!r} must be a bool, not {value!r}") from error


def as_text(value: Any, field: str) -> str:
    """Return a string. Raise FieldError for other values."""
    if not isinstance(value, str):
        raise FieldError(f"field {field!r} must be a string, not {value!r}")
    return value


def as_numbers(values: Iterable[Any], base: str, size: int, field: str) -> array[Any]:
    """Return numbers packed as `base`; a `size` of 0 allows any length. Raise FieldError for a wrong length or type."""
    if isinstance(values, str) or not hasattr(values, "__len__"):
        raise FieldError(f"field {field!r} must be a sequence of {base}, not {values!r}")
    try:
        packed = array(CODES[base], values)
    except (TypeError, OverflowError) as error:
        raise FieldError(f"field {field!r} must hold values of type {base}: {error}") from error
    if size and len(packed) != size:
        raise FieldError(f"field {field!r} must hold {size} values, not {len(packed)}")
    return packed


def as_list(values: Any, size: int, field: str, convert: Callable[[Any, str], Any]) -> list[Any]:
    """Return a list of converted elements; `size` 0 allows any length. Raise FieldError for a wrong length or type."""
    if isinstance(values, str | bytes) or not hasattr(values, "__iter__"):
        raise FieldError(f"field {field!r} must be a sequence, not {values!r}")
    converted = [convert(value, field) for value in values]
    if size and len(converted) != size:
        raise FieldError(f"field {field!r} must hold {size} elements, not {len(converted)}")
    return converted


def scalar_converter(base: str) -> Callable[[Any, str], Any]:
    """Return the conversion for an element of a primitive type (other than ROS 1 times)."""
    if base in INTEGERS:
        return lambda value, field: as_integer(value, base, field)
    return {
        "float64": as_float,
        "float32": as_float32,
        "bool": as_bool,
        "string": as_text,
        "wstring": as_text,
    }[base]
