"""Find the numbers in a launch file that determine a parameter."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

DEEPEST = 20  # maximum number of names and arguments between a parameter and a number
_NUMERAL = re.compile(r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*")
_TRUTH = {"true": True, "false": False}
# functions that return their first argument, possibly converted to another type
_SAME = ("float", "int", "str", "ParameterValue", "TextSubstitution")


class _NoNumberError(Exception):
    """An expression is not a number that the file determines."""


@dataclass(frozen=True, slots=True)
class Numeral:
    """A number in a launch file that determines a parameter, as a node of the syntax tree.

    To multiply the parameter by f, multiply the number by (1 + (f - 1) · `share`).
    """

    node: ast.expr
    value: bool | int | float
    share: float = 1.0


def key_of(name: str) -> str:
    """Return the last part of a parameter's name, such as `gain`."""
    return re.split(r"[/.~]", name)[-1]


def numerals(key: str, tree: ast.Module) -> Iterator[Numeral]:
    """Yield the numbers that determine parameters named `key`."""
    names = _Names.of(tree)
    for expression in _expressions(key, tree):
        found = _written(expression)
        if isinstance(found, bool):
            yield Numeral(expression, found)
            continue
        try:
            yield from _determining(expression, names)
        except _NoNumberError:
            continue


def computed(key: str, tree: ast.Module) -> Iterator[ast.expr]:
    """Yield the expressions for parameters named `key` that have no number to change."""
    names = _Names.of(tree)
    for expression in _expressions(key, tree):
        try:
            found = _written(expression) is not None or any(_determining(expression, names))
        except _NoNumberError:
            found = False
        if not found:
            yield expression


@dataclass
class _Names:
    """The values of names and launch arguments that are assigned once."""

    assigned: dict[str, ast.expr] = field(default_factory=dict)
    arguments: dict[str, ast.expr] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: ast.Module) -> _Names:
        """Return the names of a file."""
        assigned: dict[str, list[ast.expr | None]] = {}
        arguments: dict[str, list[ast.expr | None]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                assigned.setdefault(node.id, []).append(None)
            elif isinstance(node, ast.arg):
                assigned.setdefault(node.arg, []).append(None)
            elif isinstance(node, ast.Call) and _function(node) == "DeclareLaunchArgument":
                name = _argument(node, 0, "name")
                if isinstance(name, ast.Constant) and isinstance(name.value, str):
                    arguments.setdefault(name.value, []).append(_argument(node, 1, "default_value"))
        for node in ast.walk(tree):
            if (
                isinstance(node, ast.Assign)
                and len(node.targets) == 1
                and isinstance(node.targets[0], ast.Name)
            ):
                assigned[node.targets[0].id][0] = node.value
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                assigned[node.target.id][0] = node.value
        return cls(_single(assigned), _single(arguments))


def _single(found: Mapping[str, list[ast.expr | None]]) -> dict[str, ast.expr]:
    return {name: one[0] for name, one in found.items() if len(one) == 1 and one[0] is not None}


def _expressions(key: str, tree: ast.Module) -> Iterator[ast.expr]:
    """Yield the expressions for parameters named `key`, in order."""
    found: list[ast.expr] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            pairs = zip(node.keys, node.values, strict=True)
            found += [value for name, value in pairs if name is not None and _is_named(name, key)]
        elif isinstance(node, ast.Call) and _function(node) == "dict":
            found += [one.value for one in node.keywords if one.arg == key]
        elif isinstance(node, ast.Call) and _function(node) == "SetParameter":
            name, value = _argument(node, 0, "name"), _argument(node, 1, "value")
            found += [value] if name is not None and value is not None and _is_named(name, key) else []
    yield from sorted(found, key=lambda one: (one.lineno, one.col_offset))


def _is_named(node: ast.expr, key: str) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and key_of(node.value) == key


def _determining(expression: ast.expr, names: _Names) -> Iterator[Numeral]:
    """Yield the numbers that an expression scales linearly. Raise _NoNumberError."""
    found: dict[int, tuple[ast.expr, int]] = {}
    whole = _value(expression, names, {}, found)
    for node, _ in sorted(found.values(), key=lambda one: one[1]):
        old = _written(node)
        if isinstance(old, bool) or not old or not whole:
            continue
        one, two = (_value(expression, names, {id(node): old + step}, {}) for step in (1.0, 2.0))
        slope = one - whole
        if slope and math.isclose(two - one, slope, rel_tol=1e-9):
            yield Numeral(node, old, whole / (slope * old))


def _value(
    node: ast.expr,
    names: _Names,
    given: Mapping[int, float],
    found: dict[int, tuple[ast.expr, int]],
    depth: int = 0,
) -> float:
    """Return the value of an expression; `given` replaces numbers, by the id of their nodes.

    Add each number to `found`, with its distance from the expression. Raise _NoNumberError.
    """
    if depth > DEEPEST:
        raise _NoNumberError
    written = _written(node)
    if written is not None and not isinstance(written, bool):
        found[id(node)] = node, depth
        return given.get(id(node), float(written))
    if isinstance(node, ast.Name) and node.id in names.assigned:
        return _value(names.assigned[node.id], names, given, found, depth + 1)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_value(node.operand, names, given, found, depth)
    if isinstance(node, ast.BinOp):
        left, right = (_value(one, names, given, found, depth) for one in (node.left, node.right))
        return _operated(node.op, left, right)
    # launch joins a list of substitutions into one text; this list has only one element
    if isinstance(node, ast.List) and len(node.elts) == 1:
        return _value(node.elts[0], names, given, found, depth)
    if isinstance(node, ast.Call) and _function(node) == "LaunchConfiguration":
        name = _argument(node, 0, "variable_name")
        if isinstance(name, ast.Constant) and name.value in names.arguments:
            return _value(names.arguments[str(name.value)], names, given, found, depth + 1)
    if isinstance(node, ast.Call) and _function(node) in _SAME and node.args:
        return _value(node.args[0], names, given, found, depth)
    raise _NoNumberError


def _operated(operator: ast.operator, left: float, right: float) -> float:
    if isinstance(operator, ast.Add):
        return left + right
    if isinstance(operator, ast.Sub):
        return left - right
    if isinstance(operator, ast.Mult):
        return left * right
    if isinstance(operator, ast.Div) and right:
        return left / right
    raise _NoNumberError


def _written(node: ast.expr) -> bool | int | float | None:
    """Return the number in a literal or string, or None."""
    sign, inner = 1, node
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        sign, inner = -1, node.operand
    if not isinstance(inner, ast.Constant):
        return None
    value = inner.value
    if isinstance(value, str) and inner is node:
        if value.strip().lower() in _TRUTH:
            return _TRUTH[value.strip().lower()]
        if _NUMERAL.fullmatch(value):
            return int(value) if value.strip().lstrip("+-").isdigit() else float(value)
        return None
    if isinstance(value, bool):
        return value if inner is node else None
    return sign * value if isinstance(value, int | float) else None


def _function(call: ast.Call) -> str:
    """Return the last part of a called function's name."""
    function = call.func
    return (
        function.attr
        if isinstance(function, ast.Attribute)
        else function.id
        if isinstance(function, ast.Name)
        else ""
    )


def _argument(call: ast.Call, number: int, name: str) -> ast.expr | None:
    plain = call.args[number] if number < len(call.args) else None
    return next((one.value for one in call.keywords if one.arg == name), plain)
