"""Evaluate constant Python expressions without executing code.

A value is a constant, a list, tuple or dict of values, a `Library` (a name imported from another module), a function
of the file itself, or a result of the models of library functions. A value that is not constant is an `Unknown`,
never an error.
"""

from __future__ import annotations

import ast
import math
import operator
import posixpath
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

LARGEST: Final = 100_000  # limit on a computed value, in characters or elements
_WIDTH: Final = re.compile(r"\d{4,}")  # a format width would make a huge string
_BINARY: Final[Mapping[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.BitOr: operator.or_, ast.BitAnd: operator.and_,
}  # fmt: skip
_COMPARE: Final[Mapping[type[ast.cmpop], Callable[[Any, Any], Any]]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge, ast.In: lambda item, many: item in many, ast.NotIn: lambda item, many: item not in many,
    ast.Is: operator.is_, ast.IsNot: operator.is_not,
}  # fmt: skip
_UNARY: Final[Mapping[type[ast.unaryop], Callable[[Any], Any]]] = {
    ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Not: operator.not_, ast.Invert: operator.invert,
}  # fmt: skip
_METHODS: Final[Mapping[type, frozenset[str]]] = {
    str: frozenset(["format", "join", "split", "strip", "lstrip", "rstrip", "lower", "upper", "replace", "startswith",
                    "endswith", "title", "capitalize"]),
    list: frozenset(["append", "extend", "insert", "index", "count", "copy"]),
    dict: frozenset(["get", "items", "keys", "values", "update", "copy", "setdefault"]),
    tuple: frozenset(["index", "count"]),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that is not constant: its line and its text."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Library:
    """A name of another module: `os.path`, `launch_ros.actions.Node`."""

    name: str


def _range(*bounds: int) -> list[int]:
    numbers = range(*bounds)
    if len(numbers) > LARGEST:
        raise ValueError("too many numbers")
    return list(numbers)


def _listed(function: Callable[..., Any]) -> Callable[..., list[Any]]:
    return lambda *args: list(function(*args))


BUILTINS: Final[Mapping[str, Any]] = {
    "str": str, "int": int, "float": float, "bool": bool, "len": len, "list": list, "tuple": tuple, "dict": dict,
    "range": _range, "min": min, "max": max, "abs": abs, "sum": sum, "round": round, "sorted": sorted, "any": any,
    "all": all, "enumerate": _listed(enumerate), "zip": _listed(zip), "reversed": _listed(reversed), "repr": repr,
}  # fmt: skip
LIBRARIES: Final[Mapping[str, Any]] = {
    "math.pi": math.pi, "math.e": math.e, "math.inf": math.inf, "math.sqrt": math.sqrt, "math.radians": math.radians,
    "numpy.pi": math.pi, "numpy.inf": math.inf, "os.path.join": posixpath.join, "os.path.basename": posixpath.basename,
    "os.path.dirname": posixpath.dirname, "os.sep": "/", "sys.maxsize": 2**63 - 1,
}  # fmt: skip


class Evaluator:
    """Evaluates the expressions of one file. `models` holds functions and values of libraries by full name."""

    def __init__(self, models: Mapping[str, Any]) -> None:
        self.models = {**LIBRARIES, **models}

    def value(self, node: ast.expr, names: Mapping[str, Any]) -> Any:
        """Return the value of an expression; `Unknown` if it is not constant."""
        visit = getattr(self, f"_{type(node).__name__.lower()}", None)
        if visit is None:
            return unknown(node)
        try:
            return visit(node, names)
        except (ArithmeticError, LookupError, TypeError, ValueError, AttributeError):
            return unknown(node)

    def call(self, function: Any, args: list[Any], keywords: dict[str, Any], node: ast.Call) -> Any:
        """Return the value of a call. Subclasses handle functions of the file."""
        if isinstance(function, Library) or not callable(function):
            return unknown(node)
        plain = function in BUILTINS.values() or function in LIBRARIES.values()
        if plain and any(isinstance(one, Unknown | Library) for one in (*args, *keywords.values())):
            return unknown(node)
        return function(*args, **keywords)

    def _constant(self, node: ast.Constant, _: Mapping[str, Any]) -> Any:
        return node.value

    def _name(self, node: ast.Name, names: Mapping[str, Any]) -> Any:
        if node.id in names:
            return names[node.id]
        return BUILTINS.get(node.id, unknown(node))

    def _attribute(self, node: ast.Attribute, names: Mapping[str, Any]) -> Any:
        base = self.value(node.value, names)
        if isinstance(base, Library):
            name = f"{base.name}.{node.attr}"
            return self.models.get(name, Library(name))
        if node.attr in _METHODS.get(type(base), ()):
            return getattr(base, node.attr)
        if getattr(type(base), "readable", None) is not None and node.attr in base.readable:
            return getattr(base, node.attr)
        return unknown(node)

    def _list(self, node: ast.List, names: Mapping[str, Any]) -> Any:
        return self._elements(node.elts, names)

    def _tuple(self, node: ast.Tuple, names: Mapping[str, Any]) -> Any:
        return tuple(self._elements(node.elts, names))

    def _set(self, node: ast.Set, names: Mapping[str, Any]) -> Any:
        return self._elements(node.elts, names)

    def _elements(self, nodes: list[ast.expr], names: Mapping[str, Any]) -> list[Any]:
        found: list[Any] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                inner = self.value(node.value, names)
                found += inner if isinstance(inner, list | tuple) else [unknown(node)]
            else:
                found.append(self.value(node, names))
        return found

    def _dict(self, node: ast.Dict, names: Mapping[str, Any]) -> Any:
        found: dict[Any, Any] = {}
        for key, item in zip(node.keys, node.values, strict=True):
            value = self.value(item, names)
            if key is None:
                found.update(value if isinstance(value, dict) else {})
            else:
                found[self.value(key, names)] = value
        return found

    def _joinedstr(self, node: ast.JoinedStr, names: Mapping[str, Any]) -> Any:
        parts = []
        for part in node.values:
            value = self.value(part.value if isinstance(part, ast.FormattedValue) else part, names)
            shaped = isinstance(part, ast.FormattedValue) and (part.format_spec or part.conversion > 0)
            if shaped or not isinstance(value, str | int | float | bool):
                return unknown(node)
            parts.append(str(value))
        return "".join(parts)

    def _binop(self, node: ast.BinOp, names: Mapping[str, Any]) -> Any:
        left, right = self.value(node.left, names), self.value(node.right, names)
        if any(isinstance(one, Unknown | Library) for one in (left, right)) or type(node.op) not in _BINARY:
            return unknown(node)
        if isinstance(node.op, ast.Mult) and not (_number(left) and _number(right)):
            size = max((len(one) for one in (left, right) if not _number(one)), default=0)
            times = left if _number(left) else right
            if not _number(times) or size * max(times, 0) > LARGEST:
                return unknown(node)
        if isinstance(node.op, ast.Mod) and isinstance(left, str):
            return unknown(node) if _WIDTH.search(left) or _holds_unknown(right) else left % right
        return _BINARY[type(node.op)](left, right)

    def _unaryop(self, node: ast.UnaryOp, names: Mapping[str, Any]) -> Any:
        value = self.value(node.operand, names)
        return unknown(node) if isinstance(value, Unknown | Library) else _UNARY[type(node.op)](value)

    def _compare(self, node: ast.Compare, names: Mapping[str, Any]) -> Any:
        left = self.value(node.left, names)
        for kind, other in zip(node.ops, node.comparators, strict=True):
            right = self.value(other, names)
            if _holds_unknown(left) or _holds_unknown(right):
                return unknown(node)
            if not _COMPARE[type(kind)](left, right):
                return False
            left = right
        return True

    def _boolop(self, node: ast.BoolOp, names: Mapping[str, Any]) -> Any:
        value: Any = None
        for operand in node.values:
            value = self.value(operand, names)
            if isinstance(value, Unknown | Library):
                return unknown(node)
            if bool(value) == isinstance(node.op, ast.Or):
                return value
        return value

    def _ifexp(self, node: ast.IfExp, names: Mapping[str, Any]) -> Any:
        test = self.value(node.test, names)
        if isinstance(test, Unknown | Library):
            return unknown(node)
        return self.value(node.body if test else node.orelse, names)

    def _subscript(self, node: ast.Subscript, names: Mapping[str, Any]) -> Any:
        base = self.value(node.value, names)
        if isinstance(node.slice, ast.Slice):
            ends = [None if n is None else self.value(n, names) for n in (node.slice.lower, node.slice.upper)]
            return base[slice(*ends)] if isinstance(base, str | list | tuple) else unknown(node)
        return (
            base[self.value(node.slice, names)]
            if isinstance(base, str | list | tuple | dict)
            else unknown(node)
        )

    def _listcomp(self, node: ast.ListComp, names: Mapping[str, Any]) -> Any:
        return self._comprehended(node.elt, node.generators, names) if node.generators else unknown(node)

    _generatorexp = _listcomp

    def _comprehended(
        self, element: ast.expr, loops: list[ast.comprehension], names: Mapping[str, Any]
    ) -> Any:
        loop, *rest = loops
        items = self.value(loop.iter, names)
        if not isinstance(items, list | tuple | dict) or not isinstance(loop.target, ast.Name):
            return unknown(element)
        found: list[Any] = []
        for item in items:
            inner = {**names, loop.target.id: item}
            tests = [self.value(test, inner) for test in loop.ifs]
            if any(isinstance(test, Unknown | Library) for test in tests):
                return unknown(element)
            if all(tests):
                found += self._comprehended(element, rest, inner) if rest else [self.value(element, inner)]
        return found

    def _call(self, node: ast.Call, names: Mapping[str, Any]) -> Any:
        function = self.value(node.func, names)
        args = self._elements(node.args, names)
        keywords: dict[str, Any] = {}
        for keyword in node.keywords:
            value = self.value(keyword.value, names)
            if keyword.arg is None:
                keywords.update(value if isinstance(value, dict) else {})
            else:
                keywords[keyword.arg] = value
        text = getattr(function, "__self__", None)
        if isinstance(text, str) and (
            _WIDTH.search(text) or _holds_unknown(args) or _holds_unknown(keywords)
        ):
            return unknown(node)
        return self.call(function, args, keywords, node)


def unknown(node: ast.AST) -> Unknown:
    """Return an `Unknown` for an expression."""
    return Unknown(getattr(node, "lineno", 0), ast.unparse(node)[:80])


def _number(value: Any) -> bool:
    return isinstance(value, int | float)


def _holds_unknown(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return any(map(_holds_unknown, value))
    if isinstance(value, dict):
        return any(map(_holds_unknown, value.values()))
    return isinstance(value, Unknown | Library)
