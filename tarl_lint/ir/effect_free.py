"""Statements that only print or log and have no other effect."""

from __future__ import annotations

import ast
import re
from typing import Final

from tarl_lint import catalog
from tarl_lint.trees import walk

OWN_PRINT: Final = re.compile(r"\bdef\s+print\b|\bprint\s*=|\bimport\b[^\n]*(\bprint\b|\*)")
ROSPY: Final = frozenset(
    f"log{level}{how}"
    for level in ("debug", "info", "warn", "err", "fatal")
    for how in ("", "_throttle", "_throttle_identical", "_once")
)
PURE: Final = frozenset(
    [
        "str",
        "repr",
        "len",
        "round",
        "int",
        "float",
        "bool",
        "format",
        "type",
        "abs",
        "min",
        "max",
        "sum",
        "sorted",
    ]
)  # names of functions without side effects
FORMATTING: Final = frozenset(["format", "join", "get_time", "to_sec", "time", "now", "get_name", "tolist"])
ACTING: Final = (ast.Await, ast.Yield, ast.YieldFrom, ast.NamedExpr)


def only_tells(expr: ast.expr, prints: bool) -> bool:
    """Return whether an expression statement prints or logs and has no other effect.

    `prints` means that `print` is Python's built-in function.
    """
    if not isinstance(expr, ast.Call) or not _tells(expr.func, prints):
        return False
    if any(keyword.arg == "file" and isinstance(keyword.value, ast.Name) for keyword in expr.keywords):
        return False  # the stream may be read again, unlike `sys.stderr`
    given = [*expr.args, *(k.value for k in expr.keywords)]
    return all(map(_pure, walk(*given)))


def _tells(function: ast.expr, prints: bool) -> bool:
    if isinstance(function, ast.Name):
        return prints and function.id == "print"
    if not isinstance(function, ast.Attribute):
        return False
    base = function.value
    if isinstance(base, ast.Name):
        return base.id == "rospy" and function.attr in ROSPY
    asked = (
        isinstance(base, ast.Call) and isinstance(base.func, ast.Attribute) and base.func.attr == "get_logger"
    )
    return asked and function.attr in catalog.LEVELS


def _pure(node: ast.AST) -> bool:
    if isinstance(node, ast.Call):
        function = node.func
        if isinstance(function, ast.Name):
            return function.id in PURE
        return isinstance(function, ast.Attribute) and function.attr in FORMATTING
    return not isinstance(node, ACTING)
