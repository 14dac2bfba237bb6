"""Operators, comparisons and formatting of constant values, within limits on the size of their results."""

from __future__ import annotations

import ast
import itertools
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from tarl_lint.workspace.python.elements import Unique, settled
from tarl_lint.workspace.python.instances import Made
from tarl_lint.workspace.python.values import LARGEST, OpaqueError

BITS: Final = 4096  # maximum size of an integer (bits)
# matches a width in a format string that would make a huge text
_WIDTH: Final = re.compile(r"\d{4,}|\*(?!\D)")
# matches fields such as `{0.name}`, which read an attribute or element
_INSIDE: Final = re.compile(r"\{[^{}:!]*[.\[]")
BINARY: Final[Mapping[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.BitOr: operator.or_, ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor, ast.Pow: operator.pow, ast.LShift: operator.lshift, ast.RShift: operator.rshift,
}  # fmt: skip
COMPARE: Final[Mapping[type[ast.cmpop], Callable[[Any, Any], Any]]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge, ast.In: lambda item, many: item in many, ast.NotIn: lambda item, many: item not in many,
}  # fmt: skip
UNARY: Final[Mapping[type[ast.unaryop], Callable[[Any], Any]]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_, ast.Invert: operator.invert,
}  # fmt: skip
# operator → name of its special methods, to which `r` (right operand) and `i` (augmented assignment) are prefixed
_SPECIAL: Final[Mapping[type[ast.operator], str]] = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "truediv", ast.FloorDiv: "floordiv", ast.Mod: "mod",
    ast.BitOr: "or", ast.BitAnd: "and", ast.BitXor: "xor", ast.Pow: "pow", ast.LShift: "lshift",
    ast.RShift: "rshift", ast.MatMult: "matmul",
}  # fmt: skip


def binary(kind: type[ast.operator], left: Any, right: Any) -> Any:
    """Return the result of an operator. Raises OpaqueError if it is too large, and any exception of the operator."""
    if isinstance(left, Made) or isinstance(right, Made):
        return _of_objects(kind, left, right)
    if kind is ast.Mod and isinstance(left, str):
        return left % for_text(left, left.count("%"), right)
    numbers = isinstance(left, int | float), isinstance(right, int | float)
    if all(numbers):
        if isinstance(left, int) and isinstance(right, int) and left.bit_length() + right.bit_length() > BITS:
            raise OpaqueError("too large a number")
        if kind is ast.LShift and right > BITS:
            raise OpaqueError("too large a number")
        if kind is ast.Pow:
            return power(left, right)
    elif kind is ast.Mult:
        many, times = (right, left) if numbers[0] else (left, right)
        limited(len(many) * max(times, 0))
    elif kind is ast.Add and isinstance(left, str | list | tuple):
        limited(len(left) + len(right))
    return BINARY[kind](left, right)


def _of_objects(kind: type[ast.operator], left: Any, right: Any) -> Any:
    """Return the result of an operator that a class of the file defines."""
    name = _SPECIAL[kind]
    if isinstance(left, Made) and left.has(f"__{name}__"):
        return left.run(f"__{name}__", right)
    if isinstance(right, Made) and right.has(f"__r{name}__"):
        return right.run(f"__r{name}__", left)
    for one in (left, right):
        if isinstance(one, Made) and one.kind.is_flag():
            return _flags(kind, one, left, right)
    plain = [one.plain() if isinstance(one, Made) else one for one in (left, right)]
    if any(isinstance(one, Made) for one in plain):
        raise OpaqueError("no such operator")
    return binary(kind, plain[0], plain[1])


def _flags(kind: type[ast.operator], of: Made, left: Any, right: Any) -> Made:
    """Return a combination of flags."""
    value = binary(
        kind, *(one.attributes["value"] if isinstance(one, Made) else one for one in (left, right))
    )
    same = of.kind.with_value(value)
    if isinstance(same, Made):
        return same
    names = [one.attributes["name"] for one in of.kind.members() if one.attributes["value"] & value]
    return Made(of.kind, {"name": "|".join(names) or None, "value": value})


def in_place(operator_: ast.operator) -> str:
    """Return the special method of an augmented assignment."""
    return f"__i{_SPECIAL[type(operator_)]}__"


def power(base: float, exponent: float, modulus: int | None = None) -> float:
    """Return a power. Raises OpaqueError if it is too large or not a real number."""
    if isinstance(base, int) and isinstance(exponent, int) and base.bit_length() * abs(exponent) > BITS:
        raise OpaqueError("too large a number")
    found: int | float | complex = base**exponent
    if isinstance(found, complex):
        raise OpaqueError("not a real number")
    return found if modulus is None else found % modulus


def formatted(value: Any, spec: str, conversion: int = -1) -> str:
    """Return a value as an f-string writes it. Raises OpaqueError if the value is not constant or too large."""
    if not (isinstance(value, BaseException) or settled(value, 1_000)) or _WIDTH.search(spec):
        raise OpaqueError("not a constant")
    if _has_address(value):
        raise OpaqueError("its text contains an address")
    if conversion == ord("a"):
        return format(ascii(value), spec)
    return format(repr(value) if conversion == ord("r") else str(value) if conversion >= 0 else value, spec)


def written(value: Any) -> str:
    """Return the result of `str`. Raises OpaqueError if it is not known."""
    return formatted(value, "", ord("s"))


def _has_address(value: Any) -> bool:
    return callable(value) and not isinstance(value, Made)


def for_text(text: str, places: int, given: Any) -> Any:
    """Return the values to insert into a string. Raises OpaqueError if they may be too large."""
    if _WIDTH.search(text) or not settled(given, 1_000):
        raise OpaqueError("not a constant")
    longest = sum(len(one) if isinstance(one, str) else 40 for one in _flat(given))
    limited(len(text) + places * longest)
    if isinstance(given, Made):
        return given.plain()
    return given


def format_text(text: str, args: list[Any], keywords: dict[str, Any]) -> str:
    """Return the result of `str.format`. Raises OpaqueError if it reads attributes, or may be too large."""
    for_text(text, text.count("{"), [args, keywords])
    if _INSIDE.search(text):
        raise OpaqueError("it reads an attribute")
    return text.format(*args, **keywords)


def _flat(value: Any) -> Iterable[Any]:
    if isinstance(value, list | tuple | Unique):
        return itertools.chain.from_iterable(map(_flat, value))
    return itertools.chain.from_iterable(map(_flat, value.values())) if isinstance(value, dict) else (value,)


def limited(size: float) -> None:
    """Raise OpaqueError if a value would be too large."""
    if size > LARGEST:
        raise OpaqueError("too large")
