"""Range checks, recognised by the syntax of a statement or condition."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final, Literal

# A function of the analysed files or of a library whose name matches is assumed to return a value within limits.
LIMITING: Final = re.compile(
    r"clamp|clip|limit|saturat|constrain|bound|restrict|normali[sz]e|wrap|thresh|sigmoid|squash|(^|_)sat(_|$)",
    re.I,
)
BOUNDED: Final = frozenset(
    [
        "min", "max", "minimum", "maximum", "fmin", "fmax", "nanmin", "nanmax", "sin", "cos", "tanh",
        "atan", "atan2", "asin", "acos", "arctan", "arctan2", "arcsin", "arccos", "sign", "copysign",
        "heaviside", "argmin", "argmax", "len", "bool", "euler_from_quaternion", "quat2euler",
        "as_euler", "fmod", "remainder", "mod", "interp", "isnan", "isinf", "isfinite",
    ]
)  # fmt: skip
# Library functions that preserve a magnitude; any other function outside the analysed files may limit it.
PASSING: Final = frozenset(
    [
        "abs", "fabs", "absolute", "sqrt", "hypot", "pow", "exp", "log", "square", "float", "int",
        "round", "floor", "ceil", "sum", "mean", "nanmean", "average", "median", "norm", "dot", "matmul",
        "array", "asarray", "list", "tuple", "deepcopy", "copy", "append", "float32", "float64",
        "subtract", "add", "multiply", "divide", "diff", "publish", "replace", "str", "radians",
        "degrees", "dist", "fsum", "get", "item", "tolist", "reshape", "flatten", "zip", "enumerate",
        "range",
    ]
)  # fmt: skip
ARITHMETIC: Final = frozenset(
    ["sqrt", "hypot", "pow", "exp", "log", "square", "sum", "mean", "norm", "dot", "dist"]
)
# Message fields whose magnitude is limited or has no meaning.
HARMLESS_FIELDS: Final = frozenset(
    [
        "header", "stamp", "frame_id", "seq", "covariance", "orientation", "axes", "buttons", "status",
        "width", "height", "encoding", "layout", "angle_min", "angle_max", "angle_increment",
        "range_min", "range_max",
    ]
)  # fmt: skip

# Arrays in messages: every element is a measurement, whatever index selects it.
MEASURED: Final = frozenset(["ranges", "intensities", "position", "velocity", "effort", "data"])

Side = Literal["above", "below", "both"]


def limits(statement: ast.AST, ours: frozenset[str]) -> bool:
    """Return whether a computed value is limited, or may be limited by code outside the analysed files."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Call) and _limiting(node, ours):
            return True
        if isinstance(node, ast.Attribute) and node.attr in HARMLESS_FIELDS:
            return True
        if isinstance(node, ast.keyword) and node.arg in HARMLESS_FIELDS:
            return True
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
            return True
        if isinstance(node, (ast.Compare, ast.JoinedStr)):
            return True
        if isinstance(node, ast.Subscript) and _looked_up(node):
            return True
    return False


def computes(statement: ast.AST) -> bool:
    """Return whether a statement computes a new number, rather than passing on a known number."""
    return any(
        isinstance(node, (ast.BinOp, ast.AugAssign))
        or (isinstance(node, ast.Call) and call_name(node) in ARITHMETIC)
        for node in ast.walk(statement)
    )


def _limiting(call: ast.Call, ours: frozenset[str]) -> bool:
    name = call_name(call)
    if name in BOUNDED or LIMITING.search(name):
        return True
    return not (name in PASSING or name in ours or name[:1].isupper())


def call_name(call: ast.Call) -> str:
    """Return the last part of the called name."""
    if isinstance(call.func, ast.Attribute):
        return call.func.attr
    return call.func.id if isinstance(call.func, ast.Name) else ""


def _looked_up(node: ast.Subscript) -> bool:
    """Return whether a computed index selects the value, for example from a table of speeds."""
    table = node.value
    name = table.attr if isinstance(table, ast.Attribute) else getattr(table, "id", "")
    return isinstance(node.slice, (ast.Attribute, ast.Call, ast.BinOp)) and name not in MEASURED


def side(test: ast.expr, *, holds: bool) -> Side:
    """Return where a value lies if a condition on it holds, or fails: above something, below something, or `both`.

    The result for a condition that is not understood is `both`, so that no conclusion is drawn from the condition.
    """
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return side(test.operand, holds=not holds)
    if isinstance(test, ast.BoolOp):
        parts = [side(v, holds=holds) for v in test.values if list(comparisons(v))]
        return parts[0] if parts and len(set(parts)) == 1 else "both"
    if not isinstance(test, ast.Compare) or len(test.ops) != 1:
        return "both"
    operator = test.ops[0]
    if not isinstance(operator, (ast.Lt, ast.LtE, ast.Gt, ast.GtE)):
        return "both"
    greater = isinstance(operator, (ast.Gt, ast.GtE))
    flipped = _fixed(test.left) and not _fixed(test.comparators[0])
    return "above" if (greater != flipped and holds) or (greater == flipped and not holds) else "below"


def comparisons(test: ast.AST) -> Iterator[ast.Compare]:
    """Yield the comparisons by size or equality in a condition."""
    for node in ast.walk(test):
        if isinstance(node, ast.Compare) and not any(isinstance(o, (ast.Is, ast.IsNot)) for o in node.ops):
            yield node


def dotted(test: ast.expr) -> Iterator[str]:
    """Yield the full names of the fields in a condition: `msg.pose.position.x`."""
    pending: list[ast.AST] = [test]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Attribute) and not _fixed(node):
            yield ast.unparse(node)
        else:
            pending += ast.iter_child_nodes(node)


def _fixed(node: ast.expr) -> bool:
    """Return whether an expression looks like a limit: a literal, or a name in capitals."""
    if isinstance(node, ast.UnaryOp):
        return _fixed(node.operand)
    if isinstance(node, ast.Attribute):
        return node.attr.isupper() or (
            isinstance(node.value, ast.Name) and node.value.id in ("math", "np", "numpy")
        )
    return isinstance(node, ast.Constant) or (isinstance(node, ast.Name) and node.id.isupper())
