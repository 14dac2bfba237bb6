"""Defaults and setters of ROS 2 fields, as in rosidl."""

# ruff: noqa: S101 (rosidl's setters assert, and `python -O` switches them off there as well)

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from typing import Any

from pytest_tarl.ros.messages.field_values import CODES, INTEGERS
from pytest_tarl.ros.messages.type_definitions import Field

Nested = Callable[[str], type]  # type name → nested message class

_FLOAT32_LIMIT = 3.402823466e38  # rosidl's limit is rounded and excludes the largest float32
LITERALS = {
    "float64": "0.0", "float32": "0.0", "bool": "False", "string": "''", "wstring": "''",
    **dict.fromkeys(set(INTEGERS) - {"byte"}, "0"),
}  # fmt: skip


def default(field: Field, nested: Nested) -> Callable[[], Any]:
    """Return a function that creates a field's default value."""
    if field.default is not None:
        return lambda: field.default
    element = _element_default(field, nested)
    if field.shape == "one":
        return element
    if field.base in CODES and field.base != "byte":
        if field.shape == "sequence":
            return lambda: array(CODES[field.base])
        return lambda: _numpy_array([0] * field.size, field.base)
    return (lambda: [element() for _ in range(field.size)]) if field.shape == "array" else list


def _element_default(field: Field, nested: Nested) -> Callable[[], Any]:
    if not field.primitive:
        return nested(field.base)
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
    import numpy as np  # needed only for fixed arrays of numbers

    return np.array(numbers, dtype=base)


def setter(field: Field, position: int, nested: Nested, scope: dict[str, Any], source: list[str]) -> str:
    """Append the source of a field's setter to `source`, put its globals into `scope`, and return its name."""
    name, check = f"set{position}", f"check{position}"
    scope[check] = _check(field, nested)
    if field.shape != "one":
        scope[f"field{position}"], scope["accepted"] = field, _accepted
        stored = f"accepted(field{position}, {check}, v)"
        source += [f"def {name}(m, v):", f"    m._{field.name} = {stored}"]
        return name
    usual = {"float64": "float", "string": "str", "bool": "bool"}.get(field.base)
    guard = f"if v.__class__ is not {usual}: " if usual else ""
    source += [f"def {name}(m, v):", f"    {guard}{check}(v)", f"    m._{field.name} = v"]
    return name


def _accepted(field: Field, check: Callable[[Any], None], value: Any) -> Any:
    """Check an assigned sequence, and convert it to the form in which rosidl stores it."""
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
    # elements of bytes need no check
    if field.base != "uint8" or not isinstance(value, bytes | bytearray):
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


def _check(field: Field, nested: Nested) -> Callable[[Any], None]:
    """Return a function that asserts the type of one element."""
    if not field.primitive:
        wanted: type = nested(field.base)
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
